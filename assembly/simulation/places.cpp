#include "assembly/simulation/places.hpp"

#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia {

Vec3d point_place(const SimulatedBody& b, std::size_t point) {
  const BodyPoint& p = b.body->points()[point];
  if (p.cell < 0 || b.groups() == nullptr) return p.X;
  const BodyCells& cells = b.body->cells();
  const int corners = node_count(cells.type);
  Vec3d sum;
  for (int k = 0; k < corners; ++k) sum += b.nodes[at(cells.nodes[at(p.cell * cells.nodes_per_cell + k)])];
  return sum * (1.0 / corners);
}

std::string point_name(const SimulatedBody& b, std::size_t point) {
  const BodyPoint& p = b.body->points()[point];
  const Vec3d X = point_place(b, point);
  const std::string place = fmt::format("at ({:.4g}, {:.4g}, {:.4g})", X[0], X[1], X[2]);
  if (p.cell < 0 || b.groups() == nullptr) return "the integration point " + place;
  return fmt::format("{} {} {}", b.body->cells().type == CellType::triangle ? "triangle" : "element",
                     b.body->cell_number(p.cell), place);
}

int body_of_node(const Simulation& s, int node) {
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const ModelBody& body = *s.bodies[b].body;
    if (node >= body.first_node() && node < body.first_node() + body.node_count()) return static_cast<int>(b);
  }
  return -1;
}

double weight_length(const Attachment& attachment) {
  double steepest = 0;
  for (const Influence& i : attachment.influences) steepest = std::max(steepest, squared_norm(i.g));
  return steepest > 0 ? 1 / std::sqrt(steepest) : 0;
}

const Material* material_of(const Body& body, const BodyPoint& point) {
  const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)); };
  for (const MaterialUse& use : body.materials)
    if (same(use.material.mu, point.mu) && same(use.material.lambda, point.lambda) && use.material.own == point.own &&
        fade_alike(use.material.viscosity, point.viscosity))
      return &use.material;
  return nullptr;
}

}  // namespace fascia
