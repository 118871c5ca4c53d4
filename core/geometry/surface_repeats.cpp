#include "core/base/index.hpp"
#include "core/geometry/surface_edges.hpp"
#include "core/geometry/surface_parts.hpp"
#include "core/geometry/surface_touching.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <numeric>

namespace fascia::surface_parts {
namespace {

/// Triangles with the same nodes, in their order in the file.
using Copies = std::vector<std::size_t>;

std::array<int, 3> key_of(const Triangle& t) {
  std::array<int, 3> key = t.nodes;
  std::sort(key.begin(), key.end());
  return key;
}

/// 1 where the nodes ascend around the triangle, −1 where they descend.
int sense(const Triangle& t) {
  const auto low = static_cast<std::size_t>(std::min_element(t.nodes.begin(), t.nodes.end()) - t.nodes.begin());
  return t.nodes[(low + 1) % 3] < t.nodes[(low + 2) % 3] ? 1 : -1;
}

std::vector<Copies> find_copies(const std::vector<Triangle>& triangles) {
  std::vector<std::size_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const auto p = key_of(triangles[a]), q = key_of(triangles[b]);
    return p != q ? p < q : a < b;
  });
  std::vector<Copies> all;
  for (std::size_t k = 0, end = 0; k < order.size(); k = end) {
    for (end = k; end < order.size() && key_of(triangles[order[end]]) == key_of(triangles[order[k]]);) ++end;
    if (end - k > 1)
      all.emplace_back(order.begin() + static_cast<std::ptrdiff_t>(k),
                       order.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return all;
}

/// What is left of copies once each pair that lies back to back is gone.
Copies without_pairs(const std::vector<Triangle>& triangles, const Copies& copies) {
  int net = 0;
  for (const std::size_t t : copies) net += sense(triangles[t]);
  Copies left;
  for (const std::size_t t : copies)
    if (static_cast<int>(left.size()) < std::abs(net) && (sense(triangles[t]) > 0) == (net > 0)) left.push_back(t);
  return left;
}

/// The triangles with some of each set of copies.
template <class Choose>
std::vector<bool> kept(std::size_t count, const std::vector<Copies>& all, const Choose& choose) {
  std::vector<bool> keep(count, true);
  for (const Copies& copies : all) {
    for (const std::size_t t : copies) keep[t] = false;
    for (const std::size_t t : choose(copies)) keep[t] = true;
  }
  return keep;
}

std::vector<Triangle> those(const std::vector<Triangle>& triangles, const std::vector<bool>& keep) {
  std::vector<Triangle> result;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (keep[t]) result.push_back(triangles[t]);
  return result;
}

/// Copies separate two large parts that hang together nowhere else: they are a wall between chambers. Where the surface
/// is the same on both sides of them they are a fin that bounds nothing.
bool are_walls(const std::vector<Triangle>& triangles, const std::vector<Copies>& all) {
  std::vector<bool> is_copy(triangles.size(), false);
  for (const Copies& copies : all)
    for (const std::size_t t : copies) is_copy[t] = true;
  const std::vector<Edge> edges = sorted_edges(triangles);
  const Components components(Neighbours(triangles.size(), edges));
  constexpr std::size_t kLarge = 20;  // a part of 1 / kLarge of all triangles
  std::vector<std::size_t> sizes(at(components.count), 0);
  for (const int c : components.of) ++sizes[at(c)];
  bool found = false;
  for_each_edge(edges, [&](std::span<const Edge> same) {
    int beside = -1;
    bool copies = false, differ = false;
    for (const Edge& edge : same) {
      const std::size_t t = at(edge.triangle);
      copies = copies || is_copy[t];
      if (is_copy[t] || kLarge * sizes[at(components.of[t])] < triangles.size()) continue;
      differ = differ || (beside >= 0 && components.of[t] != beside);
      beside = components.of[t];
    }
    found = found || (copies && differ);
  });
  return found;
}

}  // namespace

std::vector<Triangle> without_repeats(const Solid& solid, Surface surface, std::vector<Triangle> triangles,
                                      std::vector<std::string>& messages) {
  const std::vector<Copies> all = find_copies(triangles);
  if (all.empty()) return triangles;
  const auto one = [](const Copies& copies) { return Copies{copies.front()}; };
  const auto rest = [&](const Copies& copies) { return without_pairs(triangles, copies); };
  const auto one_of_rest = [&](const Copies& copies) {
    Copies left = rest(copies);
    left.resize(std::min<std::size_t>(left.size(), 1));
    return left;
  };
  const std::size_t count = triangles.size();
  std::vector<bool> keep = kept(count, all, one);
  const bool fins = surface == Surface::of_solid || !are_walls(triangles, all);
  if (fins && branches(those(triangles, keep))) {
    for (const std::vector<bool>& other : {kept(count, all, one_of_rest), kept(count, all, rest)}) {
      const std::vector<Triangle> chosen = those(triangles, other);
      if (chosen.empty() || !encloses(chosen)) continue;
      keep = other;
      break;
    }
  }
  std::size_t left_out = 0, first = count, first_other = count;
  for (const Copies& copies : all)
    for (const std::size_t t : copies) {
      if (keep[t]) continue;
      ++left_out;
      if (t >= first) continue;
      first = t;
      first_other = copies[copies[0] == t ? 1 : 0];
    }
  if (left_out > 0)
    messages.push_back(solid.file + ": left out " + std::to_string(left_out) +
                       (left_out == 1 ? " triangle that has the nodes of another (triangle "
                                      : " triangles that have the nodes of others (the first: triangle ") +
                       std::to_string(triangles[first].file_number) + ", which lies on triangle " +
                       std::to_string(triangles[first_other].file_number) + ")");
  return those(triangles, keep);
}

}  // namespace fascia::surface_parts
