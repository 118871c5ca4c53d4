#include "shells/generate.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/primitives.hpp"
#include "shells/generate_cap.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace fascia {
namespace {

void check_cells(const char* what, int count, int least) {
  if (count < least)
    throw InputError(std::string("cells ") + what + ": " + std::to_string(count) +
                     " is out of range; must be at least " + std::to_string(least));
}

void check_cells(const std::array<const char*, 2>& what, const std::array<int, 2>& cells, const Turn* turn,
                 std::size_t around) {
  for (std::size_t d = 0; d < 2; ++d) check_cells(what[d], cells[d], turn && turn->closed && d == around ? 3 : 1);
  if (1.0 * cells[0] * cells[1] > 1e7) throw InputError("more than 10 million cells; give fewer");
}

void check_turn(const Turn& turn) {
  constexpr double whole = 2 * std::numbers::pi;
  const double angle = turn.to - turn.from;
  if (!(angle > 0) || !(angle <= whole * (1 + 1e-9)))
    throw InputError("an angle from " + std::to_string(turn.from) + " to " + std::to_string(turn.to) +
                     " rad; must be ascending, at most a whole turn");
  if (turn.closed && !(angle >= whole * (1 - 1e-9))) throw InputError("a closed turn must be a whole one");
}

/// @param dimension  1: an edge, 2: triangles
void add_group(ShellMesh& mesh, const char* name, int dimension, std::vector<int> nodes, std::vector<int> cells = {}) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  const int number = static_cast<int>(mesh.groups.size()) + 1;
  mesh.groups.push_back({name, number, dimension, std::move(nodes), std::move(cells)});
}

/// The triangles from `first` on and their nodes.
void add_face(ShellMesh& mesh, const char* name, std::size_t first) {
  std::vector<int> nodes, cells;
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    cells.push_back(static_cast<int>(t));
    nodes.insert(nodes.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  add_group(mesh, name, 2, std::move(nodes), std::move(cells));
}

/// Names of the first and last column and the first and last row of a grid.
using EdgeNames = std::array<const char*, 4>;

/// Nodes at place(i, j), i first, and the cells between them; `wraps`: the last column or row is the first, and has no
/// name. The normal points along (place along i) × (place along j).
template <class Place>
ShellMesh grid(const std::array<int, 2>& cells, const std::array<bool, 2>& wraps, const EdgeNames& names,
               Diagonal diagonal, Place&& place) {
  ShellMesh mesh;
  const std::array<int, 2> count{cells[0] + (wraps[0] ? 0 : 1), cells[1] + (wraps[1] ? 0 : 1)};
  for (int j = 0; j < count[1]; ++j)
    for (int i = 0; i < count[0]; ++i) mesh.nodes.push_back(place(i, j));
  const auto node = [&](int i, int j) { return i % count[0] + count[0] * (j % count[1]); };
  for (int j = 0; j < cells[1]; ++j)
    for (int i = 0; i < cells[0]; ++i) {
      const int a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
      const bool right = diagonal == Diagonal::right || (diagonal == Diagonal::alternating && (i + j) % 2 == 0);
      mesh.triangles.push_back(right ? std::array{a, b, c} : std::array{a, b, d});
      mesh.triangles.push_back(right ? std::array{a, c, d} : std::array{b, c, d});
    }
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const std::size_t across = edge / 2;
    if (wraps[across]) continue;
    const int place_across = edge % 2 == 0 ? 0 : cells[across];
    std::vector<int> nodes(at(count[1 - across]));
    for (int k = 0; k < count[1 - across]; ++k)
      nodes[at(k)] = across == 0 ? node(place_across, k) : node(k, place_across);
    add_group(mesh, names[edge], 1, std::move(nodes));
  }
  return mesh;
}

/// Direction of node `i` of `cells` around an axis, of length one.
class Around {
 public:
  Around(const Vec3d& axis, const Turn& turn, int cells)
      : e1_(angle_origin(axis)), e2_(cross(normalized(axis), e1_)), turn_(turn), cells_(cells) {}

  Vec3d operator()(int i) const {
    const double angle = i == cells_ ? turn_.to : turn_.from + (turn_.to - turn_.from) * i / cells_;
    return std::cos(angle) * e1_ + std::sin(angle) * e2_;
  }

 private:
  Vec3d e1_, e2_;
  Turn turn_;
  int cells_;
};

bool has_direction(const Vec3d& v) { return std::isfinite(norm(v)) && norm(v) > 0; }

}  // namespace

Vec3d angle_origin(const Vec3d& axis) {
  const Vec3d a = normalized(axis);
  int nearest = 0;
  for (int c = 1; c < 3; ++c)
    if (std::abs(a[c]) > std::abs(a[nearest]) * (1 + 1e-9)) nearest = c;
  Vec3d next{};
  next[(nearest + 1) % 3] = 1;
  return normalized(next - dot(next, a) * a);
}

ShellMesh rectangle(const Vec3d& origin, const Vec3d& edge_u, const Vec3d& edge_v, const std::array<int, 2>& cells,
                    Diagonal diagonal) {
  check_cells({"along edge_u", "along edge_v"}, cells, nullptr, 0);
  if (!has_direction(edge_u) || !has_direction(edge_v) ||
      norm(cross(edge_u, edge_v)) < 1e-6 * norm(edge_u) * norm(edge_v))
    throw InputError("the rectangle's edges vanish or are parallel; must have two directions");
  return grid(cells, {false, false}, {"u0", "u1", "v0", "v1"}, diagonal,
              [&](int i, int j) { return origin + edge_u * (1.0 * i / cells[0]) + edge_v * (1.0 * j / cells[1]); });
}

ShellMesh annulus(const Vec3d& center, const Vec3d& normal, double inner, double outer, const Turn& turn,
                  const std::array<int, 2>& cells, Diagonal diagonal) {
  check_cells({"outward", "around"}, cells, &turn, 1);
  check_turn(turn);
  if (!has_direction(normal)) throw InputError("the annulus has no normal; must be a direction");
  if (!(inner > 0) || !(outer > inner) || !std::isfinite(outer))
    throw InputError("the annulus has no width; its radii must be 0 < inner < outer");
  const Around direction(normal, turn, cells[1]);
  return grid(cells, {false, turn.closed}, {"inner", "outer", "start", "end"}, diagonal, [&](int i, int j) {
    const double radius = i == cells[0] ? outer : inner + (outer - inner) * i / cells[0];
    return center + radius * direction(j);
  });
}

ShellMesh cylinder_skin(const Vec3d& from, const Vec3d& to, double radius, const Turn& turn, bool caps,
                        const std::array<int, 2>& cells, Diagonal diagonal) {
  check_cells({"along", "around"}, cells, &turn, 1);
  check_turn(turn);
  if (!has_direction(to - from) || !(radius > 0) || !std::isfinite(radius))
    throw InputError("the cylinder has no length or radius; must be above 0");
  if (caps && !turn.closed) throw InputError("a sector of a cylinder has no caps; leave them out");
  const int along = cells[0], around = cells[1];
  const Around direction(to - from, turn, around);
  ShellMesh mesh =
      grid({around, along}, {turn.closed, false}, {"start", "end", "from", "to"}, diagonal, [&](int i, int j) {
        const Vec3d middle = j == along ? to : from + (to - from) * (1.0 * j / along);
        return middle + radius * direction(i);
      });
  if (!caps) return mesh;
  std::vector<int> rim(at(around));
  for (int i = 0; i < around; ++i) rim[at(i)] = i + around * along;
  add_face(mesh, "side", 0);
  std::size_t first = mesh.triangles.size();
  shell_parts::add_cap(mesh, rim);
  add_face(mesh, "cap_to", first);
  first = mesh.triangles.size();
  for (int i = 0; i < around; ++i) rim[at(i)] = (around - i) % around;  // counter-clockwise from the other side
  shell_parts::add_cap(mesh, rim);
  add_face(mesh, "cap_from", first);
  return mesh;
}

ShellMesh ellipsoid_skin(const Vec3d& center, const Vec3d& radii, int around) {
  if (around < 4 || around % 4 != 0)
    throw InputError("cells around: " + std::to_string(around) + " is out of range; must be a multiple of 4");
  if (around > 10000) throw InputError("more than 10 million cells; give fewer");
  for (int c = 0; c < 3; ++c)
    if (!(radii[c] > 0) || !std::isfinite(radii[c])) throw InputError("the ellipsoid's radii must be above 0");
  TriangleMesh surface = ellipsoid_surface(center, radii, around / 4);
  ShellMesh mesh;
  mesh.nodes = std::move(surface.points);
  mesh.triangles = std::move(surface.triangles);
  return mesh;
}

}  // namespace fascia
