#include "meshless/grid_body.hpp"

#include "core/base/errors.hpp"

#include "core/base/index.hpp"
#include "meshless/weights.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia {

namespace {

/// Above this Poisson ratio full integration locks (docs/manual/meshless.md, "Nearly incompressible tissue").
constexpr double kSelectivePoisson = 0.45 + 1e-9;  // rounding of λ and μ must not decide about 0.45 itself

}  // namespace

void GridBody::add_points(const GridSpec& spec, const std::vector<Sample>& samples, const Model& model,
                          PointSetBuilder& builder) {
  const double length = std::cbrt(spacing_[0] * spacing_[1] * spacing_[2]);
  std::vector<PointMaterialSpec> materials;
  bool nearly_incompressible = false;
  for (const Sample& s : samples) {
    materials.push_back(spec.material(to_world(s.x)));
    nearly_incompressible = nearly_incompressible || largest_poisson(materials.back()) > kSelectivePoisson;
    if (spec.integration == IntegrationKind::selective && materials.back().lambda < 0)
      throw InputError("selective integration needs a Poisson ratio that is not negative; use integration = \"full\"");
  }
  // Affine frames do not lock; one point a cell would take a part of their bending away.
  const bool thick = !spec.affine && *std::min_element(grid_.begin(), grid_.end()) >= 3;
  selective_ = weights_ == GridWeightKind::trilinear &&
               (spec.integration == IntegrationKind::selective ||
                (spec.integration == IntegrationKind::automatic && nearly_incompressible && thick));
  if (selective_ && spec.affine)
    messages_.push_back(
        "selective integration takes a part of the bending stiffness of affine frames away, which do not "
        "lock; use integration = \"auto\"");
  constexpr double little = 0.3;  // of the shear modulus: the points' own volume term is then above twice of it
  if (selective_ && std::any_of(materials.begin(), materials.end(), [](const PointMaterialSpec& m) {
        return m.viscosity && m.viscosity->shear_only && m.viscosity->long_term() < little;
      }))
    messages_.push_back(
        "relaxes in shear to less than 0.3 of its stiffness: what fades of the shear takes a part of selective "
        "integration away, and the body locks in the long term; use relax = \"all\", or elements of order 2");
  if (selective_ && spec.integration == IntegrationKind::automatic)
    choices_.push_back("Poisson ratio above 0.45: lambda is integrated at one point a cell (selective integration)");

  std::vector<char> held(still_.empty() ? 0 : at(model.node_count()));
  // Weights of a point's blended rotation, among nodes that turn; 0: no stabilisation.
  const auto stabilization_of = [&](const PointMaterialSpec& m, Attachment& a) {
    if (still_.empty()) return spec.stabilization * m.mu;
    const bool still = std::any_of(a.nodes.begin(), a.nodes.end(),
                                   [&](int node) { return std::binary_search(still_.begin(), still_.end(), node); });
    const double gamma = blend_turning(a.nodes, still_, a.influences) ? spec.stabilization * m.mu : 0.0;
    for (std::size_t k = 0; k < a.nodes.size() && (!still || gamma > 0); ++k) held[at(a.nodes[k])] = 1;
    return gamma;
  };

  // Points that share their frames, in the order of the cells (and tetrahedra).
  std::map<std::tuple<int, std::array<int, 3>, Law, std::size_t>, std::vector<std::size_t>> groups;
  std::vector<std::shared_ptr<const Viscosity>> viscosities;  // those that differ
  const auto number_of = [&](const std::shared_ptr<const Viscosity>& viscosity) {
    const auto known = std::find_if(viscosities.begin(), viscosities.end(),
                                    [&](const auto& other) { return fade_alike(other, viscosity); });
    const auto number = static_cast<std::size_t>(known - viscosities.begin());
    if (known == viscosities.end()) viscosities.push_back(viscosity);
    return number;
  };
  for (std::size_t q = 0; q < samples.size(); ++q)
    groups[{cells_[at(samples[q].cell)].owner, samples[q].tetrahedron, materials[q].law,
            number_of(materials[q].viscosity)}]
        .push_back(q);
  for (const auto& [key, members] : groups) {
    std::vector<PointSample> points;
    std::vector<int> nodes;
    PointSample volumetric;
    for (const std::size_t q : members) {
      const Sample& s = samples[q];
      Attachment a = attach_local(s.x, s.cell, weights_ == GridWeightKind::linear ? &s.tetrahedron : nullptr);
      const PointMaterialSpec& m = materials[q];
      const Vec3d X = to_world(s.x);
      const double stabilization = stabilization_of(m, a);
      points_.push_back({m, X, s.volume, X, m.law});
      point_cells_.push_back({a.cell, s.tetrahedron});
      points.push_back({m,
                        X,
                        s.volume,
                        stabilization,
                        m.stiffness_damping,
                        std::move(a.influences),
                        {},
                        static_cast<int>(points_.size()) - 1});
      if (selective_) points.back().lambda = 0;
      nodes = a.nodes;
      volumetric.volume += s.volume;
      volumetric.own.assign(m.own.size(), 0.0);
      volumetric.viscosity = m.viscosity;
      volumetric.lambda += s.volume * m.lambda;
      volumetric.stiffness_damping += s.volume * m.stiffness_damping;
    }
    if (selective_) {
      volumetric.lambda /= volumetric.volume;
      volumetric.stiffness_damping /= volumetric.volume;
      const int cell = std::get<int>(key);
      const Attachment a = attach_local(cells_[at(cell)].center, cell, nullptr);
      volumetric.influences = a.influences;
      volumetric.source = PointSample::kVolumetric;
      points.push_back(volumetric);
    }
    builder.add_points(
        nodes, points, length,
        {std::get<Law>(key), spec.affine ? Stabilization::affine : Stabilization::drilling, spec.affine});
  }
  if (!still_.empty()) check_held(*this, model, still_, held);
}

/// Any partition of unity gives a rigid motion its exact kinetic energy, since each frame takes the full lever. It is
/// that of the weights inside; in cut cells frames take less, as their support is smaller: the weight of much matter on
/// a long lever would turn a frame that hardly any point ties to the rest. Points lent to a cell count at their nearest
/// place in it, so that no frame's mass turns negative.
void GridBody::add_inertia(const GridSpec& spec, const std::vector<Sample>& samples, Model& model) {
  model.inertia.resize(model.rest_position.size());
  const std::vector<double> support = frame_support(samples);
  for (const Sample& s : samples) {
    const CellShare share = cell_share(s);
    const Vec3d X = to_world(s.x);
    const double mass_damping = spec.material(X).mass_damping;
    if (mass_damping > 0) model.mass_damping.resize(model.rest_position.size());
    double sum = 0;
    for (std::size_t k = 0; k < share.w.size(); ++k) sum += share.w[k] * support[at(share.grid_node[k])];
    std::vector<MassShare> masses;
    for (std::size_t k = 0; k < share.w.size(); ++k) {
      const SharedFrame* other = share_at(share.grid_node[k]);
      const int frame = frame_of_grid_node_[at(share.grid_node[k])];
      masses.push_back({frame, spec.density * s.volume * share.w[k] * support[at(share.grid_node[k])] / sum,
                        X - model.rest_position[at(frame)], other == nullptr || other->turns});
    }
    add_masses(masses, mass_damping, model);
  }
  if (!model.mass_damping.empty()) model.mass_damping.resize(model.rest_position.size());
}

/// Weights of the frames of a point's cell, the point moved to its nearest place in that cell.
GridBody::CellShare GridBody::cell_share(const Sample& s) const {
  const Cell& owner = cells_[at(cells_[at(s.cell)].owner)];
  Vec3d xi = cell_coordinates(s.x, owner);
  for (int a = 0; a < 3; ++a) xi[a] = std::clamp(xi[a], 0.0, 1.0);
  CellShare share;
  const auto fill = [&](const auto& weights) {
    for (std::size_t k = 0; k < weights.w.size(); ++k) {
      share.grid_node.push_back(grid_node(owner.index, weights.corner[k]));
      share.w.push_back(weights.w[k]);
    }
  };
  if (weights_ == GridWeightKind::trilinear)
    fill(TrilinearWeights::at(xi));
  else
    fill(LinearWeights::at(xi));
  return share;
}

/// Part of a frame's weight function, over the cells around it that have points, that the matter fills: 1 in a box.
/// By nodes of the grid.
std::vector<double> GridBody::frame_support(const std::vector<Sample>& samples) const {
  std::vector<double> filled(frame_of_grid_node_.size()), full(frame_of_grid_node_.size(), 0.0);
  for (const Sample& s : samples) {
    const CellShare share = cell_share(s);
    for (std::size_t k = 0; k < share.w.size(); ++k) filled[at(share.grid_node[k])] += s.volume * share.w[k];
  }
  const double cell_volume = spacing_[0] * spacing_[1] * spacing_[2];
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    if (cells_[c].owner != static_cast<int>(c)) continue;
    for (int corner = 0; corner < 8; ++corner) {
      // Linear weights: six tetrahedra meet at both ends of the main diagonal, two at the other corners.
      const double part =
          weights_ == GridWeightKind::trilinear ? 1.0 / 8 : (corner == 0 || corner == 7 ? 1.0 / 4 : 1.0 / 12);
      full[at(grid_node(cells_[c].index, corner))] += part * cell_volume;
    }
  }
  for (std::size_t i = 0; i < filled.size(); ++i)
    if (full[i] > 0) filled[i] = std::min(1.0, filled[i] / full[i]);
  return filled;
}

}  // namespace fascia
