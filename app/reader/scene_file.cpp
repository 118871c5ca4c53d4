#include "fascia/scene_file.hpp"

#include "app/reader/parse.hpp"
#include "assembly/specification/errors.hpp"

namespace fascia {

Scene read_scene_file(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  Scene scene = app::parse_scene_file(path, overrides);
  if (scene.states_need())
    throw SceneError({{scene.place_of("need"),
                       "states a need, and leaves its resolution to `fascia run`; write what that chose into the "
                       "scene"}});
  return scene;
}

}  // namespace fascia
