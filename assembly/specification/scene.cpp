#include "assembly/specification/scene.hpp"

#include <algorithm>

namespace fascia {

bool Scene::states_need() const {
  return need || std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return body.need.has_value(); });
}

Place Scene::place_of(const std::string& key) const {
  std::string known = key;
  while (!known.empty() && !says(known)) {
    const std::size_t end = known.find_last_of(".[");
    known.resize(end == std::string::npos ? 0 : end);
  }
  Place place = says(known) ? places.at(known) : Place{path.string(), 0, 0, ""};
  place.key = key;
  return place;
}

}  // namespace fascia
