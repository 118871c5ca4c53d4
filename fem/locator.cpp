#include "fem/locator.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fascia {
namespace {

constexpr double tolerance = 1e-10;  // of an element's or the mesh's size

/// How far a curved element may leave the bounding box of its corners along each axis [m]: its place is the linear one
/// and Σ N_k δ_k with δ_k the middle node's distance from the middle of its edge and Σ N_k at most 3 (tetrahedra: 1.5).
Vec3d bulge(const ElementMesh& mesh, std::size_t element) {
  Vec3d most;
  if (order_of(mesh.shape) == 1) return most;
  const auto nodes = mesh.element(element);
  const double sum = family_of(mesh.shape) == ElementFamily::tetrahedra ? 1.5 : 3;
  std::size_t k = at(corner_count(mesh.shape));
  for (const auto& [a, b] : edges_of(family_of(mesh.shape))) {
    const Vec3d straight = 0.5 * (mesh.nodes[at(nodes[at(a)])] + mesh.nodes[at(nodes[at(b)])]);
    const Vec3d d = mesh.nodes[at(nodes[k++])] - straight;
    for (int c = 0; c < 3; ++c) most[c] = std::max(most[c], sum * std::abs(d[c]));
  }
  return most;
}

}  // namespace

ElementLocator::ElementLocator(ElementMesh mesh) : mesh_(std::move(mesh)), boundary_(boundary_faces(mesh_).surface) {
  boxes_.reserve(mesh_.size());
  for (std::size_t e = 0; e < mesh_.size(); ++e) {
    boxes_.push_back(box_of(e));
    whole_.include(boxes_[e]);
  }
  if (boxes_.empty()) return;
  // Points on an element's own border count as in its box, whatever the rounding.
  const double margin = tolerance * whole_.diagonal();
  for (Bounds& box : boxes_)
    for (int c = 0; c < 3; ++c) {
      box.low[c] -= margin;
      box.high[c] += margin;
    }
  size_grid();
  fill_cells();
}

Bounds ElementLocator::box_of(std::size_t element) const {
  Bounds box;
  for (const int n : mesh_.element(element).first(at(corner_count(mesh_.shape)))) box.include(mesh_.nodes[at(n)]);
  const Vec3d more = bulge(mesh_, element);
  return {box.low - more, box.high + more};
}

/// Cells about as large as the elements' boxes are on average, along each axis.
void ElementLocator::size_grid() {
  constexpr double most = 1024;
  Vec3d mean;
  for (const Bounds& box : boxes_) mean += box.extent();
  mean *= 1 / static_cast<double>(boxes_.size());
  double total = 1;
  Vec3d count;
  for (int c = 0; c < 3; ++c) {
    count[c] = std::clamp((whole_.high[c] - whole_.low[c]) / mean[c], 1.0, most);
    total *= count[c];
  }
  // A mesh that fills little of its box must not have more cells than elements, by far.
  const double shrink = std::min(1.0, std::cbrt(2 * static_cast<double>(boxes_.size()) / total));
  for (int c = 0; c < 3; ++c) cells_[at(c)] = std::max(1, static_cast<int>(count[c] * shrink));
}

int ElementLocator::cell_along(int axis, double coordinate) const {
  const int n = cells_[at(axis)];
  const double width = (whole_.high[axis] - whole_.low[axis]) / n;
  return static_cast<int>(std::clamp(std::floor((coordinate - whole_.low[axis]) / width), 0.0, n - 1.0));
}

std::size_t ElementLocator::cell_at(const Vec3d& X) const {
  return at(cell_along(0, X[0])) + at(cells_[0]) * (at(cell_along(1, X[1])) + at(cells_[1]) * at(cell_along(2, X[2])));
}

template <class Act>
void ElementLocator::for_each_cell(const Bounds& box, Act&& act) const {
  std::array<int, 3> first{}, last{};
  for (int c = 0; c < 3; ++c) {
    first[at(c)] = cell_along(c, box.low[c]);
    last[at(c)] = cell_along(c, box.high[c]);
  }
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) act(at(i) + at(cells_[0]) * (at(j) + at(cells_[1]) * at(k)));
}

void ElementLocator::fill_cells() {
  begin_.assign(at(cells_[0]) * at(cells_[1]) * at(cells_[2]) + 1, 0);
  for (const Bounds& box : boxes_) for_each_cell(box, [&](std::size_t cell) { ++begin_[cell + 1]; });
  for (std::size_t cell = 1; cell < begin_.size(); ++cell) begin_[cell] += begin_[cell - 1];
  members_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t e = 0; e < boxes_.size(); ++e)
    for_each_cell(boxes_[e], [&](std::size_t cell) { members_[next[cell]++] = static_cast<int>(e); });
}

template <class Act>
void ElementLocator::for_each_near(const Vec3d& X, Act&& act) const {
  const std::size_t cell = cell_at(X);
  for (std::size_t m = begin_[cell]; m < begin_[cell + 1]; ++m)
    if (boxes_[at(members_[m])].contains(X) && act(at(members_[m]))) return;
}

Located ElementLocator::locate(const Vec3d& X) const {
  Located best;
  best.distance = std::numeric_limits<double>::infinity();
  if (boxes_.empty()) return best;
  const double rounding = 1e-13 * whole_.diagonal();
  const auto found = [&] {
    if (best.element < 0) return false;
    return best.distance <= tolerance * boxes_[at(best.element)].diagonal();
  };
  // Of elements that meet at the nearest place, the first stays: rounding does not decide.
  const auto offer = [&](std::size_t element) {
    const Located here = nearest_in_element(mesh_, element, X);
    if (here.distance < best.distance - rounding) best = here;
    return found();
  };
  for_each_near(X, offer);
  if (found()) {
    best.distance = 0;
    return best;
  }
  Vec3d y;
  boundary_.distance(X, &y);
  for_each_near(y, offer);
  return best;
}

}  // namespace fascia
