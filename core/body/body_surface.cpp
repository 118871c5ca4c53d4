#include "core/body/body_surface.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace fascia {

namespace {

std::size_t corners_of(const BodyFace& face) { return face.size() % 3 == 0 ? 3 : 4; }

/// Calls act(from, to) for each edge of a face.
template <class Act>
void for_each_edge(const BodyFace& face, const Act& act) {
  const std::size_t n = corners_of(face);
  for (std::size_t k = 0; k < n; ++k) act(face[k], face[(k + 1) % n]);
}

}  // namespace

std::vector<std::array<int, 2>> free_edges(const std::vector<BodyFace>& faces) {
  std::map<std::pair<int, int>, int> net;  // times from low to high, less times back
  for (const BodyFace& face : faces)
    for_each_edge(face, [&](int a, int b) { net[std::minmax(a, b)] += a < b ? 1 : -1; });
  std::vector<std::array<int, 2>> free;
  for (const auto& [edge, times] : net)
    if (times != 0) free.push_back({edge.first, edge.second});
  return free;
}

std::vector<std::vector<BodyFace>> connected_faces(const std::vector<BodyFace>& faces) {
  std::vector<int> part(faces.size());
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&](int f) {
    while (part[at(f)] != f) f = part[at(f)] = part[at(part[at(f)])];
    return f;
  };
  std::map<std::pair<int, int>, int> seen;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for_each_edge(faces[f], [&](int a, int b) {
      const int face = static_cast<int>(f), other = seen.try_emplace(std::minmax(a, b), face).first->second;
      const int i = root(face), j = root(other);
      part[at(std::max(i, j))] = std::min(i, j);
    });
  std::map<int, std::vector<BodyFace>> by_root;
  for (std::size_t f = 0; f < faces.size(); ++f) by_root[root(static_cast<int>(f))].push_back(faces[f]);
  std::vector<std::vector<BodyFace>> parts;
  parts.reserve(by_root.size());
  for (auto& [first, members] : by_root) parts.push_back(std::move(members));
  return parts;
}

std::vector<BodyFace> turned_over(const std::vector<BodyFace>& faces) {
  std::vector<BodyFace> turned = faces;
  for (BodyFace& face : turned) {
    const auto corners = static_cast<std::ptrdiff_t>(corners_of(face));
    std::reverse(face.begin(), face.begin() + corners);  // the middle of the last edge stays the last
    if (face.end() - face.begin() > corners) std::reverse(face.begin() + corners, face.end() - 1);
  }
  return turned;
}

namespace {

std::vector<SurfaceShare> shares_of(const Attachment& a) {
  std::vector<SurfaceShare> shares;
  for (std::size_t k = 0; k < a.nodes.size(); ++k)
    if (a.influences[k].w != 0 || squared_norm(a.influences[k].b) > 0)
      shares.push_back({a.nodes[k], a.influences[k].w, a.influences[k].b});
  return shares;
}

}  // namespace

SurfaceLoad surface_of(const ModelBody& body, const std::vector<BodyFace>& faces) {
  SurfaceLoad load;
  const std::vector<Vec3d>& X = body.surface().points;
  std::map<int, int> vertex;
  for (const BodyFace& face : faces)
    for (const int point : face) vertex.try_emplace(point, 0);
  bool nodes = true;  // every vertex is one
  for (auto& [point, number] : vertex) {
    const Attachment a = body.attach_surface(at(point));
    nodes = nodes && a.nodes.size() == 1;
    number = add_vertex(load, X[at(point)], shares_of(a));
  }
  std::map<std::pair<int, int>, int> middle;
  for (const BodyFace& face : faces) {
    std::vector<int> vertices;
    for (const int point : face) vertices.push_back(vertex[point]);
    for (std::size_t k = 0; !nodes && face.size() == 3 && k < 3; ++k) {
      const auto [edge, fresh] = middle.try_emplace(std::minmax(face[k], face[(k + 1) % 3]), load.vertex_count());
      const Vec3d half = (X[at(edge->first.first)] + X[at(edge->first.second)]) * 0.5;
      if (fresh) add_vertex(load, half, shares_of(body.attach(half)));
      vertices.push_back(edge->second);
    }
    add_face(load, vertices);
  }
  load.closed = load.has_potential = free_edges(faces).empty();
  measure_at_rest(load);
  return load;
}

}  // namespace fascia
