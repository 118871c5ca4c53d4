#include "app/estimate/resolution.hpp"

#include "assembly/simulation/regions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr double kMostCells = 1e7;

/// A name as a part of a key.
std::string key_part(const std::string& name) {
  const bool bare = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-';
  });
  return bare ? name : "\"" + name + "\"";
}

std::string times(const std::vector<int>& counts) { return fmt::format("{}", fmt::join(counts, " x ")); }

/// Dimension of what a meshless body fills; a mesh of several counts by the largest that it says it has.
int dimension_of(const Body& body) {
  if (const auto* between = std::get_if<BetweenDomain>(&body.domain))
    return between->as == BetweenKind::volume ? 3 : between->as == BetweenKind::sheet ? 2 : 1;
  return !body.thickness.empty() ? 2 : body.radius ? 1 : 3;
}

/// Why another resolution would be another problem; empty where it would not.
std::string tied_to_nodes(const Scene& scene, const std::string& body) {
  const auto numbers = [](const std::string& key) { return key + " names its nodes by their numbers"; };
  for (const Constraint& c : scene.constraints)
    if (c.body == body && names_ids(c.where)) return numbers(c.place.key + ".where");
  for (const Load& load : scene.loads) {
    if (load.body != body) continue;
    const bool one_node = load.where && std::holds_alternative<NearestRegion>(load.where->shape);
    if (load.force_per_node && !one_node) return load.place.key + ".force_per_node is a force for each node";
    if (load.where && names_ids(*load.where)) return numbers(load.place.key + ".where");
  }
  for (const Coupling& c : scene.couplings)
    if (c.body == body && names_ids(c.where)) return numbers(c.place.key + ".where");
  for (const Probe& p : scene.probes)
    if (p.body == body && p.where && names_ids(*p.where)) return numbers(p.place.key + ".where");
  for (const Body& other : scene.bodies)
    for (const SharedNodes& share : other.shares.value_or(std::vector<SharedNodes>{}))
      if (share.body == body && names_ids(share.where)) return numbers(share.place.key + ".where");
  return "";
}

/// The key of a domain whose mesh is generated; null for others.
const char* generated_key(const Scene& scene, const Body& body, const std::string& path) {
  if (std::holds_alternative<BoxDomain>(body.domain)) return "box";
  if (std::holds_alternative<BlockDomain>(body.domain)) return "block";
  if (std::holds_alternative<CylinderDomain>(body.domain)) return "cylinder";
  if (std::holds_alternative<RectangleDomain>(body.domain)) return "rectangle";
  if (std::holds_alternative<AnnulusDomain>(body.domain)) return "annulus";
  if (std::holds_alternative<EllipsoidDomain>(body.domain))
    return scene.says(path + ".domain.sphere") ? "sphere" : "ellipsoid";
  return nullptr;
}

/// Changes one body after the other.
class Resizer {
 public:
  /// @param exact  numbers of cells that cannot be divided are no reason to round
  Resizer(const Scene& scene, double ratio, bool exact) : scene_(scene), ratio_(ratio), exact_(exact) {}

  void resize(const Body& body) {
    name_ = body.name;
    path_ = "bodies." + key_part(body.name);
    const std::string tied = tied_to_nodes(scene_, body.name);
    if (!tied.empty())
      keep(tied);
    else if (body.model == BodyModel::meshless)
      resize_frames(body);
    else if (const auto* file = std::get_if<FileDomain>(&body.domain))
      resize_file(*file, is_shell(body) ? 2 : 3);
    else
      resize_cells(body);
  }

  SceneTwin take() { return std::move(twin_); }

 private:
  void keep(const std::string& why) { twin_.kept.push_back(fmt::format("\"{}\" stays: {}", name_, why)); }
  template <class Value>
  void set(const std::string& key, const Value& value) {
    twin_.overrides.push_back(fmt::format("{}.{}={}", path_, key, value));
  }
  void tell(double growth, const std::string& change) {
    twin_.nodes[name_] = growth;
    twin_.changes.push_back(fmt::format("\"{}\" {}", name_, change));
  }

  /// A number of cells at the new resolution; 0 where the old one cannot be divided.
  int scaled(int cells, int multiple) const {
    const double wanted = cells * ratio_;
    const int rounded = multiple * std::max(1, static_cast<int>(std::lround(std::min(wanted, kMostCells) / multiple)));
    return exact_ && std::abs(rounded - wanted) > 1e-9 * wanted ? 0 : rounded;
  }

  /// Counts of cells, each a multiple of a number; empty, with the reason told, where they cannot be had.
  std::vector<int> scaled(const std::vector<int>& cells, const std::vector<int>& multiples, int most) {
    std::vector<int> result;
    double product = 1;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      result.push_back(scaled(cells[i], multiples[i]));
      product *= result.back();
      if (result.back() == 0)
        return keep(fmt::format("{} cells cannot be joined by {:g}", cells[i], 1 / ratio_)), std::vector<int>{};
      if (result.back() > most || product > kMostCells)
        return keep(fmt::format("it would have more cells than the program takes")), std::vector<int>{};
    }
    if (result == cells) return keep(fmt::format("its {} cells round to the same", times(cells))), std::vector<int>{};
    return result;
  }

  void resize_frames(const Body& body) {
    if (std::holds_alternative<ListedFrames>(body.frames)) return keep("its frames are listed in the scene");
    if (std::holds_alternative<SampleFile>(body.frames)) return keep("its frames come from a file");
    if (std::holds_alternative<SampleFile>(body.points)) return keep("its points come from a file");
    const double growth = std::pow(ratio_, dimension_of(body));
    if (const auto* grid = std::get_if<GridFrames>(&body.frames)) {
      std::vector<int> cells = grid->count;
      for (int& n : cells) --n;
      std::vector<int> frames = scaled(cells, std::vector<int>(cells.size(), 1), 999);
      if (frames.empty()) return;
      double more = 1;
      for (std::size_t i = 0; i < frames.size(); ++i) more *= 1.0 * ++frames[i] / grid->count[i];
      set("frames.grid", fmt::format("[{}]", fmt::join(frames, ", ")));
      tell(more, fmt::format("has {} frames in the place of {}", times(frames), times(grid->count)));
    } else if (const auto* spaced = std::get_if<SpacedSamples>(&body.frames)) {
      set("frames.poisson_disk", spaced->spacing / ratio_);
      tell(growth, fmt::format("has frames every {:.4g} m in the place of {:.4g} m", spaced->spacing / ratio_,
                               spaced->spacing));
    } else {
      const int before = std::get<CountedSamples>(body.frames).count;
      const double wanted = std::round(before * growth);
      if (wanted > kMostCells) return keep("it would have more frames than the program takes");
      const int count = std::max(1, static_cast<int>(wanted));
      if (count == before) return keep(fmt::format("its {} frames round to the same", before));
      set("frames.count", count);
      tell(growth, fmt::format("has {} frames in the place of {}", count, before));
    }
    resize_points(body, growth);
    if (body.support) set("weights.radius", *body.support / ratio_);
  }

  void resize_points(const Body& body, double growth) {
    if (const auto* spaced = std::get_if<SpacedSamples>(&body.points))
      set("points.poisson_disk", spaced->spacing / ratio_);
    if (const auto* counted = std::get_if<CountedSamples>(&body.points))
      set("points.count", static_cast<long>(std::clamp(std::round(counted->count * growth), 1.0, 1e8)));
  }

  void resize_file(const FileDomain& file, int dimension) {
    const double levels = std::log2(ratio_);
    const int refine = file.refine + static_cast<int>(std::lround(levels));
    if (exact_ && std::abs(levels - std::round(levels)) > 1e-9)
      return keep("the cells of its mesh are cut by halves only");
    if (refine == file.refine) return keep("the cells of its mesh are cut by halves only");
    if (refine < 0) return keep(fmt::format("{} has no coarser mesh", file.path.filename().string()));
    if (refine > 6) return keep("its cells would be cut more often than the program does");
    set("domain.refine", refine);
    tell(std::pow(2.0, dimension * (refine - file.refine)),
         fmt::format("has the cells of its mesh {}", refine == 0   ? "as they are"
                                                     : refine == 1 ? "cut once"
                                                                   : fmt::format("cut {} times", refine)));
  }

  void resize_cells(const Body& body) {
    const char* key = generated_key(scene_, body, path_);
    if (key == nullptr || !body.cells) return keep("its mesh is not generated");
    const std::vector<int>& before = body.cells->count;
    const bool round = std::holds_alternative<EllipsoidDomain>(body.domain);
    const bool cylinder = std::holds_alternative<CylinderDomain>(body.domain), solid = is_mesh_model(body);
    std::vector<int> multiples(before.size(), 1);
    if (round) multiples[0] = 4;
    if (cylinder && solid) multiples[1] = 4;
    const std::vector<int> cells = scaled(before, multiples, 10000);
    if (cells.empty()) return;
    double growth = 1;
    for (std::size_t i = 0; i < cells.size(); ++i) growth *= 1.0 * cells[i] / before[i];
    if (round) growth *= 1.0 * cells[0] / before[0];              // a number around counts in two directions
    if (cylinder && solid) growth *= 1.0 * cells[1] / before[1];  // likewise
    set(fmt::format("domain.{}.cells", key), fmt::format("[{}]", fmt::join(cells, ", ")));
    tell(growth, fmt::format("has {} cells in the place of {}", times(cells), times(before)));
  }

  const Scene& scene_;
  double ratio_;
  bool exact_;
  SceneTwin twin_;
  std::string name_, path_;
};

/// Calls change(body) for the bodies that are meant; those without resolution only where they are named.
template <class Change>
void for_bodies(const Scene& scene, const std::optional<std::string>& name, SceneTwin& twin, Change&& change) {
  for (const Body& body : scene.bodies) {
    if (name && body.name != *name) continue;
    if (!is_carrier(body))
      change(body);
    else if (name)
      twin.kept.push_back(fmt::format("\"{}\" stays: it has no unknowns of its own field", body.name));
  }
}

SceneTwin resized_by(const Scene& scene, double ratio, bool exact, const std::optional<std::string>& name) {
  Resizer resizer(scene, ratio, exact);
  SceneTwin passed;
  for_bodies(scene, name, passed, [&](const Body& body) { resizer.resize(body); });
  return passed + resizer.take();
}

}  // namespace

SceneTwin operator+(SceneTwin a, const SceneTwin& b) {
  a.overrides.insert(a.overrides.end(), b.overrides.begin(), b.overrides.end());
  a.changes.insert(a.changes.end(), b.changes.begin(), b.changes.end());
  a.kept.insert(a.kept.end(), b.kept.begin(), b.kept.end());
  for (const auto& [body, growth] : b.nodes) a.nodes.try_emplace(body, 1).first->second *= growth;
  return a;
}

SceneTwin resized(const Scene& scene, double ratio, const std::optional<std::string>& body) {
  return resized_by(scene, ratio, false, body);
}

SceneTwin refined(const Scene& scene, int factor, const std::optional<std::string>& body) {
  return resized_by(scene, factor, true, body);
}

SceneTwin coarsened(const Scene& scene, int factor, const std::optional<std::string>& body) {
  return resized_by(scene, 1.0 / factor, true, body);
}

SceneTwin raised_order(const Scene& scene, const std::optional<std::string>& name) {
  SceneTwin twin;
  for_bodies(scene, name, twin, [&](const Body& body) {
    const auto keep = [&](const char* why) { twin.kept.push_back(fmt::format("\"{}\" stays: {}", body.name, why)); };
    const std::string tied = tied_to_nodes(scene, body.name);
    if (!tied.empty()) return keep(tied.c_str());
    if (!is_mesh_model(body)) return keep("only tetrahedra and hexahedra have an order");
    if (body.order == 2) return keep("its elements are quadratic");
    if (body.locking == Locking::f_bar) return keep("its remedy against locking needs linear elements");
    twin.overrides.push_back(fmt::format("bodies.{}.order=2", key_part(body.name)));
    twin.changes.push_back(fmt::format("\"{}\" has quadratic elements in the place of linear ones", body.name));
    twin.nodes[body.name] = body.model == BodyModel::tetrahedra ? 8 : 4;
  });
  return twin;
}

}  // namespace fascia::app
