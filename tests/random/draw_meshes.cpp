#include "tests/random/random_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace fascia::random_scenes {
namespace {

/// Groups of a mesh: nodes at both ends of a body along x, and a part of its cells.
constexpr int kNear = 1, kFar = 2, kPart = 3;

/// A box, or a flat piece of it, cut into cells whose nodes are moved at random within what they lie in: a corner
/// stays, an edge, a face and the box keep their shape.
class MeshDrawing {
 public:
  /// @param cells  along x, y and z; none along z in a rectangle
  MeshDrawing(Draws& draws, const Vector& min, const Vector& max, const std::array<int, 3>& cells)
      : draws_(draws), min_(min), max_(max), n_(cells) {}

  /// @param model  of the body
  MeshFile draw(const std::string& model) {
    number_nodes();
    each_cell([&](const std::array<int, 3>& at) {
      if (n_[2] == 0)
        add_triangles(at);
      else if (model == "hexahedra")
        add({corner(at, 0), corner(at, 1), corner(at, 3), corner(at, 2), corner(at, 4), corner(at, 5), corner(at, 7),
             corner(at, 6)});
      else
        add_tetrahedra(at);
    });
    if (draws_.chance(0.1))
      for (MeshCell& cell : mesh_.cells) turn_over(cell);  // all of them: nothing is wrong
    return mesh_;
  }

  /// Adds the nodes at an end as cells of their own.
  void add_end(MeshFile& mesh, int group) const {
    for (std::size_t i = 0; i < place_.size(); ++i)
      if (static_cast<int>(i) % (n_[0] + 1) == (group == kNear ? 0 : n_[0])) mesh.cells.push_back({{place_[i]}, group});
  }

 private:
  template <class F>
  void each_cell(const F& f) const {
    for (int k = 0; k < std::max(1, n_[2]); ++k)
      for (int j = 0; j < n_[1]; ++j)
        for (int i = 0; i < n_[0]; ++i) f({i, j, k});
  }

  /// In an order that is drawn.
  void number_nodes() {
    const int count = (n_[0] + 1) * (n_[1] + 1) * (n_[2] + 1);
    place_.resize(static_cast<std::size_t>(count));
    std::iota(place_.begin(), place_.end(), 0);
    for (int i = count - 1; i > 0; --i)
      std::swap(place_[static_cast<std::size_t>(i)], place_[static_cast<std::size_t>(draws_.whole(0, i))]);
    mesh_.nodes.resize(place_.size());
    for (int i = 0; i < count; ++i) {
      const int x = i % (n_[0] + 1), yz = i / (n_[0] + 1);
      const std::array<int, 3> at{x, yz % (n_[1] + 1), yz / (n_[1] + 1)};
      for (std::size_t a = 0; a < 3; ++a) mesh_.nodes[node(i)][a] = coordinate(at[a], a);
    }
  }

  /// So little off the regular grid that no cell turns inside out.
  double coordinate(int at, std::size_t axis) {
    if (at == 0) return min_[axis];
    if (at == n_[axis]) return max_[axis];
    return min_[axis] + (max_[axis] - min_[axis]) * (at + draws_.uniform(-0.15, 0.15)) / n_[axis];
  }

  std::size_t node(int in_order) const { return static_cast<std::size_t>(place_[static_cast<std::size_t>(in_order)]); }

  /// @param bits  of a corner: along x, y and z
  int corner(const std::array<int, 3>& at, int bits) const {
    const int i = at[0] + bits % 2, j = at[1] + bits / 2 % 2, k = at[2] + bits / 4;
    return static_cast<int>(node(i + (n_[0] + 1) * (j + (n_[1] + 1) * k)));
  }

  void add(std::vector<int> nodes) { mesh_.cells.push_back({std::move(nodes), 0}); }

  void add_triangles(const std::array<int, 3>& at) {
    const int a = corner(at, 0), b = corner(at, 1), c = corner(at, 3), d = corner(at, 2);
    if (draws_.chance(0.5))
      add({a, b, c}), add({a, c, d});
    else
      add({a, b, d}), add({b, c, d});
  }

  /// Six ways along edges from the lowest corner to the highest.
  void add_tetrahedra(const std::array<int, 3>& at) {
    static constexpr std::array<std::array<int, 2>, 6> ways{{{1, 3}, {2, 6}, {4, 5}, {2, 3}, {4, 6}, {1, 5}}};
    for (std::size_t w = 0; w < ways.size(); ++w) {
      MeshCell cell{{corner(at, 0), corner(at, ways[w][0]), corner(at, ways[w][1]), corner(at, 7)}, 0};
      if (w >= 3) turn_over(cell);
      mesh_.cells.push_back(cell);
    }
  }

  Draws& draws_;
  Vector min_, max_;
  std::array<int, 3> n_;
  std::vector<int> place_;
  MeshFile mesh_;
};

std::array<int, 3> cells_of(Draws& draws, const Json& shape) {
  std::array<int, 3> n{draws.whole(1, 3), draws.whole(1, 2), draws.whole(1, 2)};
  if (shape.contains("cells"))
    for (std::size_t a = 0; a < shape["cells"].size(); ++a) n[a] = shape["cells"][a];
  if (!shape.contains("min")) n[2] = 0;
  return n;
}

/// Bodies of elements and shells keep the groups of a mesh.
bool keeps_groups(const Json& body) {
  return body["model"] == "tetrahedra" || body["model"] == "hexahedra" || body["model"] == "shell";
}

/// Groups in the place of the ends of a body, by name as Gmsh has it or by number.
void use_ends(Draws& draws, const MeshDrawing& drawing, const RowBody& b, const Scales& s, MeshFile& mesh,
              Json& scene) {
  for (const int group : {kNear, kFar}) {
    drawing.add_end(mesh, group);
    const Json end = end_of(b, group == kFar, s);
    for (const char* section : {"constraints", "loads"})
      if (scene.contains(section))
        for (Json& entry : scene[section])
          if (entry["body"] == b.name && entry.contains("where") && entry["where"] == end && draws.chance(0.7)) {
            entry["where"] = Json::object({{"group", group}});
            if (draws.chance(0.5)) entry["where"]["group"] = fmt::format("{}", group);
          }
  }
}

/// Another stiffness in a part of the cells.
void use_part(Draws& draws, MeshFile& mesh, Json& body) {
  const int count = static_cast<int>(mesh.cells.size());
  if (count < 2 || body["material"].contains("lame")) return;
  const int part = draws.whole(1, count - 1);
  for (int c = 0; c < part; ++c) mesh.cells[static_cast<std::size_t>(c)].group = kPart;
  Json other = body["material"];
  const double part_of_it = draws.decades(-1, 0);
  for (const char* key : {"young", "c10", "c01", "c20", "c02", "bulk"})
    if (other.contains(key)) other[key] = other[key].get<double>() * part_of_it;
  const Json in_part{{"where", Json::object({{"group", kPart}})}, {"use", other}};
  body["material"] = Json::array({in_part, Json::object({{"use", body["material"]}})});
}

/// Makes one thing of a mesh wrong.
void spoil_mesh(Draws& draws, const std::string& name, int cells, bool solid, RandomScene& scene) {
  MeshFile& mesh = scene.meshes[name];
  MeshCell& cell = mesh.cells[static_cast<std::size_t>(draws.whole(0, cells - 1))];
  const int kind = draws.whole(0, solid && cells > 1 ? 4 : 3);
  scene.blamed = name;
  if (kind == 0) {
    scene.wrong = "a missing node of a mesh";
    cell.nodes[0] = static_cast<int>(mesh.nodes.size());
  } else if (kind == 1) {
    scene.wrong = "a degenerate cell of a mesh";
    cell.nodes[0] = cell.nodes[1];
  } else if (kind == 2) {
    scene.wrong = "a coordinate of a mesh that is no number";
    mesh.nodes[static_cast<std::size_t>(cell.nodes[0])][static_cast<std::size_t>(draws.whole(0, 2))] =
        std::numeric_limits<double>::quiet_NaN();
  } else if (kind == 3) {
    scene.wrong = "a mesh that is cut off";
    mesh.part = draws.uniform(0, 0.95);
  } else {
    scene.wrong = "an inverted cell of a mesh";
    turn_over(cell);
  }
}

}  // namespace

void add_mesh(Draws& draws, const Scales& s, const std::vector<RowBody>& row, const std::string& file,
              RandomScene& scene) {
  std::vector<const RowBody*> boxes;
  for (const RowBody& b : row) {
    const Json& body = scene.tree["bodies"][b.name];
    const bool on_grid = body.contains("frames") && body["frames"].contains("grid");
    if (body["domain"].contains("box") || (is_rectangle(body) && !on_grid)) boxes.push_back(&b);
  }
  if (boxes.empty()) return;
  const RowBody& b = *draws.pick(boxes);
  Json& body = scene.tree["bodies"][b.name];
  const Json shape = body["domain"].begin().value();
  const bool solid = shape.contains("min");
  const Vector min = shape[solid ? "min" : "origin"].get<Vector>();
  Vector max = min;
  for (std::size_t a = 0; a < 3; ++a)
    max[a] = solid ? shape["max"][a].get<double>()
                   : min[a] + shape["edge_u"][a].get<double>() + shape["edge_v"][a].get<double>();
  MeshDrawing drawing(draws, min, max, cells_of(draws, shape));
  MeshFile mesh = drawing.draw(body["model"]);
  const int cells = static_cast<int>(mesh.cells.size());
  const std::string ending = draws.chance(0.5) ? ".msh" : ".vtk", name = file + ending;
  body["domain"] = Json::object({{"file", name}});
  if (keeps_groups(body)) {
    if (draws.chance(0.3)) body["domain"]["refine"] = 1;
    if (draws.chance(0.4)) use_part(draws, mesh, body);
    use_ends(draws, drawing, b, s, mesh, scene.tree);
  }
  if (draws.chance(0.5)) {
    static const std::map<std::string, double> units{{"mm", 1e-3}, {"cm", 1e-2}, {"km", 1e3}, {"ft", 0.3048}};
    const std::string unit = draws.pick<std::string>({"mm", "cm", "km", "ft"});
    body["domain"]["unit"] = unit;
    for (Vector& x : mesh.nodes)
      for (double& c : x) c /= units.at(unit);
    scene.features.emplace_back("mesh in another unit");
  }
  scene.meshes[name] = std::move(mesh);
  scene.features.push_back("mesh " + ending);
  scene.features.push_back("mesh of " + body["model"].get<std::string>());
  if (draws.chance(0.15)) spoil_mesh(draws, name, cells, solid, scene);
}

}  // namespace fascia::random_scenes
