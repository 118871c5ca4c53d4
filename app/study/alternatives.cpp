#include "app/study/alternatives.hpp"

#include "app/reader/parse.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/toml_text.hpp"
#include "core/base/errors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

namespace fascia::app {
namespace {

const Body& body_of(const Scene& scene, const std::string& name) {
  std::vector<std::string> known;
  for (const Body& body : scene.bodies) {
    if (body.name == name) return body;
    known.push_back(body.name);
  }
  throw InputError(unknown_name("body", name, known));
}

/// Cells along each direction of a box or rectangle; none where the body says none.
std::optional<std::vector<int>> cells_of(const Body& body) {
  if (body.cells) return body.cells->count;
  if (const auto* grid = std::get_if<GridFrames>(&body.frames); body.model == BodyModel::meshless && grid != nullptr) {
    std::vector<int> cells;
    for (const int frames : grid->count) cells.push_back(std::max(1, frames - 1));
    return cells;
  }
  return std::nullopt;
}

class Alternative {
 public:
  Alternative(const Scene& scene, const Body& body)
      : scene_(scene), body_(body), path_("bodies." + toml_key(body.name)), cells_(cells_of(body)) {}

  std::vector<std::string> frames(bool affine, bool sheet) {
    const bool surface = std::holds_alternative<RectangleDomain>(body_.domain);
    if (sheet != surface)
      throw InputError(fmt::format("body {} {} surface; frames fill a solid, \"sheet\" a surface",
                                   in_quotes(body_.name), surface ? "is a" : "is no"));
    remove({"formulation", "order", "locking", "incompressibility"});
    const bool had_frames = scene_.says(key("frames"));
    if (body_.cells) remove_cells();
    set("model", "\"meshless\"");
    if (!had_frames) {
      if (!cells_ || !has_grid())
        throw InputError(
            fmt::format("body {} says no frames, and its domain has no cells to take them from; write "
                        "alternatives, with `frames`",
                        in_quotes(body_.name)));
      std::vector<int> grid;
      for (const int cells : *cells_) grid.push_back(cells + 1);
      set("frames.grid", fmt::format("[{}]", fmt::join(grid, ", ")));
    }
    if (affine != body_.affine) set("frames.kind", affine ? "\"affine\"" : "\"rigid\"");
    return std::move(overrides_);
  }

  std::vector<std::string> elements(const char* model, int order) {
    remove_frames();
    if (order != body_.order || !scene_.says(key("order"))) set("order", std::to_string(order));
    add_cells(model);
    return std::move(overrides_);
  }

  std::vector<std::string> shell() {
    remove_frames();
    remove({"formulation", "order", "locking", "incompressibility"});
    add_cells("shell");
    return std::move(overrides_);
  }

 private:
  std::string key(const std::string& name) const { return path_ + "." + name; }
  std::string domain_key(const std::string& name) const { return key("domain." + domain_name() + "." + name); }
  void set(const std::string& name, const std::string& value) { overrides_.push_back(key(name) + "=" + value); }
  void remove(const std::vector<std::string>& names) {
    for (const std::string& name : names)
      if (scene_.says(key(name))) overrides_.push_back(key(name) + "=");
  }
  void remove_frames() { remove({"frames", "points", "weights", "integration", "through"}); }
  void remove_cells() {
    for (const char* name : {"cells", "split", "diagonal"})
      if (scene_.says(domain_key(name))) overrides_.push_back(domain_key(name) + "=");
  }

  bool has_grid() const {
    return std::holds_alternative<BoxDomain>(body_.domain) || std::holds_alternative<RectangleDomain>(body_.domain);
  }

  /// The key of the domain that the scene says.
  std::string domain_name() const {
    for (const char* name : {"box", "block", "cylinder", "ellipsoid", "sphere", "rectangle", "annulus", "line"})
      if (scene_.says(key(std::string("domain.") + name))) return name;
    return "file";
  }

  void add_cells(const char* model) {
    if (std::string(model) != "tetrahedra" && scene_.says(domain_key("split")))
      overrides_.push_back(domain_key("split") + "=");
    set("model", fmt::format("\"{}\"", model));
    if (body_.cells || std::holds_alternative<FileDomain>(body_.domain)) return;
    if (!cells_ || !has_grid())
      throw InputError(
          fmt::format("body {} says no cells; give them to its domain, or write alternatives", in_quotes(body_.name)));
    overrides_.push_back(fmt::format("{}=[{}]", domain_key("cells"), fmt::join(*cells_, ", ")));
  }

  const Scene& scene_;
  const Body& body_;
  std::string path_;
  std::optional<std::vector<int>> cells_;
  std::vector<std::string> overrides_;
};

}  // namespace

std::vector<std::string> model_alternative(const std::filesystem::path& scene,
                                           const std::vector<std::string>& overrides, const std::string& body,
                                           const std::string& model) {
  const Scene parsed = parse_scene_file(scene, overrides);
  Alternative alternative(parsed, body_of(parsed, body));
  if (model == "frames" || model == "affine") return alternative.frames(model == "affine", false);
  if (model == "sheet") return alternative.frames(false, true);
  if (model == "shell") return alternative.shell();
  const bool quadratic = model.ends_with("-2");
  return alternative.elements(model.starts_with("tetrahedra") ? "tetrahedra" : "hexahedra", quadratic ? 2 : 1);
}

}  // namespace fascia::app
