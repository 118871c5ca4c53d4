#include "fem/element_body.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/space_order.hpp"
#include "fem/quadrature.hpp"
#include "fem/quality.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia {

namespace {

/// Above this Poisson ratio linear elements lock (docs/manual/elements.md, "Nearly incompressible tissue"); rounding of
/// λ and μ must not decide about the ratio itself.
constexpr double kLockingPoisson = 0.45 + 1e-9;

double mean_edge(const ElementMesh& mesh) {
  double sum = 0;
  const auto edges = edges_of(family_of(mesh.shape));
  for (std::size_t e = 0; e < mesh.size(); ++e)
    for (const auto& edge : edges)
      sum += norm(mesh.nodes[at(mesh.element(e)[at(edge[1])])] - mesh.nodes[at(mesh.element(e)[at(edge[0])])]);
  return sum / static_cast<double>(edges.size() * mesh.size()) / order_of(mesh.shape);
}

/// Elements of a law in an order in which neighbours are near each other.
std::vector<std::size_t> ordered(const ElementMesh& mesh, const std::vector<std::size_t>& chosen) {
  std::vector<Vec3d> middles;
  middles.reserve(chosen.size());
  for (const std::size_t e : chosen) middles.push_back(element_middle(mesh, e));
  std::vector<std::size_t> order = order_in_space(middles);
  for (std::size_t& i : order) i = chosen[i];
  return order;
}

}  // namespace

std::vector<BodyGroup> body_groups(const ElementMesh& mesh) {
  std::vector<BodyGroup> groups;
  for (const ElementGroup& g : mesh.groups) groups.push_back({g.name, g.number, g.dimension, g.nodes, g.elements});
  return groups;
}

ElementBody::ElementBody(ElementBodySpec spec, Model& model, PointSetBuilder& points)
    : locator_(std::move(spec.mesh)), formulation_(spec.formulation), penalty_(spec.penalty) {
  messages_ = mesh().messages;
  for (std::size_t e = 0; e < mesh().size(); ++e)
    material_.push_back(spec.material(element_middle(mesh(), e), static_cast<int>(e)));
  choose_formulation(spec);
  number_nodes(model);
  add_points(spec);
  add_elements(spec, points);
  add_mass(spec, model);
  material_ = {};
  describe();
}

std::string ElementBody::model_name() const {
  return family_of(mesh().shape) == ElementFamily::tetrahedra ? "tetrahedra" : "hexahedra";
}

Law ElementBody::law(int element) const {
  if (formulation_ == ElementFormulation::linear) return Law::linear;
  if (formulation_ == ElementFormulation::corotational) return Law::corotational;
  const std::size_t first = at(element) * (points_.size() / mesh().size());
  return points_[first].law;
}

namespace {

/// Volumes averaged about nodes take one viscosity, of all the stiffness.
bool take_averages(const std::vector<PointMaterialSpec>& materials) {
  const std::shared_ptr<const Viscosity>& first = materials[0].viscosity;
  return !(first && first->shear_only) &&
         std::all_of(materials.begin(), materials.end(),
                     [&](const PointMaterialSpec& m) { return fade_alike(m.viscosity, first); });
}

}  // namespace

void ElementBody::choose_formulation(const ElementBodySpec& spec) {
  const bool nearly = std::any_of(material_.begin(), material_.end(),
                                  [](const PointMaterialSpec& m) { return largest_poisson(m) > kLockingPoisson; });
  const bool can_average = mesh().shape == ElementShape::tet4 && formulation_ == ElementFormulation::large_strain;
  const bool fading = take_averages(material_);
  averaged_ = spec.locking == ElementLocking::averaged ||
              (spec.locking == ElementLocking::automatic && nearly && can_average && fading);
  if (averaged_ && !can_average)
    throw InputError("locking = \"f-bar\" is for linear tetrahedra of large strain; must be \"none\" here");
  if (averaged_ && spec.locking == ElementLocking::automatic)
    choices_.push_back(
        "Poisson ratio above 0.45: the volumetric strain is averaged about the nodes (locking = \"f-bar\")");
  if (nearly && !averaged_ && order_of(mesh().shape) == 1)
    messages_.push_back("linear elements lock at a Poisson ratio above 0.45: much too stiff; use order = 2" +
                        std::string(mesh().shape != ElementShape::tet4 ? ""
                                    : fading                           ? ", or locking = \"f-bar\" with large strain"
                                             : "; volumes are averaged only where all materials have one "
                                               "viscosity with relax = \"all\""));
}

void ElementBody::number_nodes(Model& model) {
  first_node_ = model.node_count();
  node_count_ = static_cast<int>(mesh().nodes.size());
  for (const Vec3d& x : mesh().nodes) {
    model.rest_position.push_back(x);
    model.rest_orientation.push_back(Mat3d::identity());
    model.frame_kind.push_back(FrameKind::vertex);
  }
  const BoundaryFaces faces = boundary_faces(mesh());
  on_boundary_.assign(mesh().nodes.size(), 0);
  for (const int node : faces.node) on_boundary_[at(node)] = 1;
  surface_.points = mesh().nodes;
  for (const auto& t : faces.surface.triangles)
    surface_.triangles.push_back({faces.node[at(t[0])], faces.node[at(t[1])], faces.node[at(t[2])]});
  size_ = bounds_of(mesh().nodes).diagonal();
  groups_ = body_groups(mesh());
  cells_.type = family_of(mesh().shape) == ElementFamily::tetrahedra ? CellType::tetrahedron : CellType::hexahedron;
  cells_.nodes_per_cell = fascia::node_count(mesh().shape);
  cells_.nodes = mesh().element_nodes;
}

void ElementBody::add_points(const ElementBodySpec& spec) {
  const std::vector<QuadraturePoint>& rule = quadrature(mesh().shape);
  points_.reserve(mesh().size() * rule.size());
  for (std::size_t e = 0; e < mesh().size(); ++e) {
    const PointMaterialSpec& m = material_[e];
    for (const QuadraturePoint& q : rule) {
      const ElementPoint p = shape_at_point(mesh(), e, q);
      const double v = p.det_J * q.weight;
      BodyPoint point{m};
      point.X = point.middle = p.X;
      point.volume = v;
      point.law = m.law;
      point.cell = static_cast<int>(e);
      if (spec.active) point.active = spec.active(p.X, point.cell);
      points_.push_back(point);
      volume_ += v;
    }
  }
  mass_ = volume_ * spec.density;
}

void ElementBody::add_elements(const ElementBodySpec& spec, PointSetBuilder& builder) {
  const std::vector<QuadraturePoint>& rule = quadrature(mesh().shape);
  const double length = mean_edge(mesh());
  const bool acts = std::any_of(points_.begin(), points_.end(), [](const BodyPoint& p) { return p.active != nullptr; });
  std::map<Law, std::vector<std::size_t>> by_law;
  for (std::size_t e = 0; e < mesh().size(); ++e) by_law[law(static_cast<int>(e))].push_back(e);
  for (const auto& [law, chosen] : by_law) {
    ElementBlockSpec block;
    block.law = law;
    block.averaged = averaged_;
    block.nodes = fascia::node_count(mesh().shape);
    block.points = static_cast<int>(rule.size());
    block.length = length;
    const std::size_t n = chosen.size(), per_point = at(block.nodes);
    block.node.reserve(n * per_point);
    block.gradient.reserve(n * rule.size() * per_point);
    block.volume.reserve(n * rule.size());
    block.material.reserve(n);
    for (const std::size_t e : ordered(mesh(), chosen)) {
      for (const int node : mesh().element(e)) block.node.push_back(first_node_ + node);
      for (const QuadraturePoint& q : rule) {
        const ElementPoint p = shape_at_point(mesh(), e, q);
        block.gradient.insert(block.gradient.end(), p.dN_dX.begin(), p.dN_dX.begin() + block.nodes);
        block.volume.push_back(p.det_J * q.weight);
      }
      const PointMaterialSpec& m = material_[e];
      block.material.push_back({m, m.stiffness_damping, spec.penalty});
      block.source.push_back(static_cast<int>(e));
      for (std::size_t q = e * rule.size(); acts && q < (e + 1) * rule.size(); ++q)
        block.active.push_back(points_[q].active);
    }
    builder.add_elements(make_element_block(block));
  }
}

void ElementBody::add_mass(const ElementBodySpec& spec, Model& model) {
  model.inertia.resize(model.rest_position.size());
  const bool linear = order_of(mesh().shape) == 1;
  const std::vector<QuadraturePoint>& rule = quadrature(mesh().shape);
  if (!linear) weights_.assign(mesh().nodes.size(), 0.0);
  for (std::size_t e = 0; e < mesh().size(); ++e) {
    ShapeValues first{}, second{};
    double sum = 0, volume = 0;
    for (const QuadraturePoint& q : rule) {
      const ElementPoint p = shape_at_point(mesh(), e, q);
      const double v = p.det_J * q.weight;
      volume += v;
      for (std::size_t a = 0; a < first.size(); ++a) {
        first[a] += v * p.N[a];
        second[a] += v * p.N[a] * p.N[a];
        sum += v * p.N[a] * p.N[a];
      }
    }
    for (std::size_t a = 0; a < mesh().element(e).size(); ++a) {
      const auto node = at(first_node_ + mesh().element(e)[a]);
      const double m = spec.density * (linear ? first[a] : second[a] * volume / sum);
      model.inertia[node].mass += m;
      if (!linear) weights_[at(mesh().element(e)[a])] += spec.density * first[a];
      if (material_[e].mass_damping > 0) {
        model.mass_damping.resize(model.rest_position.size());
        model.mass_damping[node].mass += m * material_[e].mass_damping;
      }
    }
  }
  if (!model.mass_damping.empty()) model.mass_damping.resize(model.rest_position.size());
}

void ElementBody::describe() {
  const MeshQuality q = mesh_quality(mesh());
  quality_ = q.sentence;
  messages_.insert(messages_.end(), q.messages.begin(), q.messages.end());
}

}  // namespace fascia
