#include "assembly/specification/check.hpp"

#include "assembly/specification/check_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace fascia {

namespace {

bool is_flat(const Domain& d) {
  return std::holds_alternative<RectangleDomain>(d) || std::holds_alternative<AnnulusDomain>(d);
}
bool is_file(const Domain& d) { return std::holds_alternative<FileDomain>(d); }
const BetweenDomain* between(const Domain& d) { return std::get_if<BetweenDomain>(&d); }

/// Directions that a domain has: 3, 2 or 1; 0 where only its file says.
std::size_t dimension(const Domain& d) {
  if (is_file(d)) return 0;
  if (const BetweenDomain* b = between(d))
    return b->as == BetweenKind::volume ? 3 : b->as == BetweenKind::sheet ? 2 : 1;
  return std::holds_alternative<LineDomain>(d) ? 1 : is_flat(d) ? 2 : 3;
}

/// True where a body of a model can have a domain.
bool fits(BodyModel model, const Domain& d) {
  const bool block = std::holds_alternative<BlockDomain>(d), box = std::holds_alternative<BoxDomain>(d);
  const bool line = std::holds_alternative<LineDomain>(d);
  switch (model) {
    case BodyModel::meshless:
      return true;
    case BodyModel::tetrahedra:
    case BodyModel::hexahedra:
      return !is_flat(d) && !line && between(d) == nullptr;
    case BodyModel::shell:
      return !box && !block && !line && between(d) == nullptr;
    default:
      return !line && !block && between(d) == nullptr;
  }
}

class Check {
 public:
  explicit Check(const Scene& scene) : scene_(scene), parts_(wrong_) {}

  void run() {
    if (scene_.bodies.empty()) parts_.wrong({}, "there is no body; give the scene one");
    for (const Body& b : scene_.bodies)
      if (!bodies_.emplace(b.name, &b).second || b.name.empty())
        parts_.wrong(b.place,
                     fmt::format("has the name \"{}\", which is empty or another body's; give each its own", b.name));
    const Place world{{}, 0, 0, "world.gravity"};
    parts_.finite(scene_.world.gravity, world);
    parts_.schedule(scene_.world.schedule, world);
    for (const Body& b : scene_.bodies) body(b);
    for (Diagnostic& circle : circles_of(scene_.bodies)) wrong_.push_back(std::move(circle));
    for (const Constraint& c : scene_.constraints) constraint(c);
    for (const Load& l : scene_.loads) load(l);
    for (const Coupling& c : scene_.couplings) coupling(c);
    for (const Probe& p : scene_.probes) probe(p);
    parts_.solver(scene_.solver);
    if (!wrong_.empty()) throw SceneError(std::move(wrong_));
  }

 private:
  const Body* known(const std::string& name, const Place& place) {
    const auto found = bodies_.find(name);
    if (found != bodies_.end()) return found->second;
    parts_.wrong(place, fmt::format("names the body \"{}\", which is not there", name));
    return nullptr;
  }
  void other(const std::string& name, const Body& own, const Place& place) {
    if (known(name, place) == &own) parts_.wrong(place, "is the body itself; must be another one");
  }

  /// Frames and points of a meshless body.
  void frames(const Body& b) {
    const std::size_t size = dimension(b.domain);
    const auto* grid = std::get_if<GridFrames>(&b.frames);
    if (grid && grid->count.empty())
      return parts_.wrong(b.frames_place, "is missing; give GridFrames, CountedSamples, SpacedSamples or ListedFrames");
    if (grid && between(b.domain))
      return parts_.wrong(b.frames_place, "is a grid, and the space between two bodies needs scattered frames");
    if (grid && std::holds_alternative<AnnulusDomain>(b.domain))
      return parts_.wrong(b.frames_place, "is a grid, and rings need scattered frames");
    if (grid && size == 0 && (b.radius || !b.thickness.empty()))
      return parts_.wrong(b.frames_place, "is a grid, and sheets and lines of a file need scattered frames");
    if (grid) parts_.counts(grid->count, size == 0 ? 3 : size, 2, b.frames_place);
    if (const auto* points = std::get_if<PerCell>(&b.points)) {
      if (!grid) parts_.wrong(b.points_place, "counts points by cell, and scattered frames have no cells");
      parts_.counts(points->count, size == 0 ? 3 : size, 1, b.points_place);
    }
    if (const auto* listed = std::get_if<ListedFrames>(&b.frames);
        listed && !listed->rotations.empty() && listed->rotations.size() != listed->positions.size())
      parts_.wrong(b.frames_place, "has lists of positions and rotations of different lengths");
    if (b.through && *b.through < 1) parts_.wrong(b.points_place, "has less than one point through the thickness");
    if (b.neighbours && *b.neighbours < 1) parts_.wrong(b.weights_place, "has less than one neighbour");
    if (b.support) parts_.positive(*b.support, b.weights_place, "support");
  }

  /// Cells of a mesh that is generated.
  void cells(const Body& b) {
    const bool meshed = is_mesh_model(b), needed = meshed || is_shell(b);
    const bool round = std::holds_alternative<CylinderDomain>(b.domain) || is_flat(b.domain);
    const bool ball = std::holds_alternative<EllipsoidDomain>(b.domain);
    if (is_file(b.domain) || b.model == BodyModel::meshless) return;
    if (!b.cells) {
      if (needed || round || ball) parts_.wrong(b.cells_place, "is missing; give MeshCells::count");
      return;
    }
    const std::size_t size = ball ? (meshed ? 2U : 1U) : round ? 2U : meshed || !is_shell(b) ? 3U : 2U;
    parts_.counts(b.cells->count, size, 1, b.cells_place);
    if (b.cells->split != 5 && b.cells->split != 6 && b.model == BodyModel::tetrahedra)
      parts_.wrong(b.cells_place, "splits a cell into neither 5 nor 6 tetrahedra");
  }

  void section(const Body& b) {
    const std::size_t size = dimension(b.domain);
    const bool thin = b.model == BodyModel::meshless && size > 0 && size < 3;
    if (thin && size == 1 && !b.radius) parts_.wrong(b.radius_place, "is missing; a line needs one");
    if ((thin && size == 2 && b.thickness.empty()) || (is_shell(b) && b.thickness.empty()))
      parts_.wrong(b.thickness_place, "is missing; a sheet or a shell needs one");
    if (b.model == BodyModel::meshless && size == 3 && (b.radius || !b.thickness.empty()))
      parts_.wrong(b.radius ? b.radius_place : b.thickness_place, "is for sheets, lines and shells, not for a solid");
  }

  void body(const Body& b) {
    if (!fits(b.model, b.domain)) return parts_.wrong(b.domain_place, "is no domain for this model of body");
    parts_.domain(b);
    if (!is_carrier(b)) {
      if (b.mass.has_value() == b.density.has_value()) parts_.wrong(b.place, "must have a mass or a density, not both");
      if (b.materials.empty()) parts_.wrong(b.place, "has no material");
    }
    if (b.mass) parts_.positive(*b.mass, b.place, "mass");
    if (b.density) parts_.positive(*b.density, b.place, "density");
    const bool small = b.formulation != Formulation::large_strain;
    const bool thin = is_shell(b) || b.radius || !b.thickness.empty();
    for (const MaterialUse& use : b.materials) {
      parts_.region(use.where, use.material.place);
      parts_.material(use.material, thin || (is_mesh_model(b) && small));
      if (is_shell(b) && use.material.activation)
        parts_.wrong(use.material.activation->place, "is not for shells; take a meshless sheet, or elements");
    }
    for (const ThicknessUse& use : b.thickness) {
      parts_.positive(use.value, b.thickness_place, "thickness");
      parts_.region(use.where, b.thickness_place);
    }
    if (b.radius) parts_.positive(*b.radius, b.radius_place, "radius");
    section(b);
    cells(b);
    if (b.model == BodyModel::meshless) frames(b);
    if (b.order != 1 && b.order != 2) parts_.wrong(b.order_place, "is out of range; must be 1 or 2");
    if (b.drilling) parts_.at_least_zero(*b.drilling, b.place, "drilling");
    parts_.at_least_zero(b.incompressibility, b.incompressibility_place, "incompressibility");
    if (b.fluid) parts_.fluid(*b.fluid);
    parts_.finite(b.initial.velocity, b.place);
    parts_.finite(b.initial.angular_velocity, b.place);
    if (b.initial.about) parts_.finite(*b.initial.about, b.place);
    if (b.shares)
      for (const SharedNodes& share : *b.shares) {
        other(share.body, b, share.body_place);
        parts_.region(share.where, share.place);
      }
    if (const BetweenDomain* gap = between(b.domain)) {
      for (std::size_t i = 0; i < 2; ++i) other(gap->bodies[i], b, gap->places[i]);
      parts_.region(gap->where, b.domain_place);
    }
    const auto carries = [&](const Coupling& c) { return c.kind != CouplingKind::spring && c.body == b.name; };
    if (b.model == BodyModel::surface && std::none_of(scene_.couplings.begin(), scene_.couplings.end(), carries))
      parts_.wrong(b.place, "rides on nothing; embed or weld it");
  }

  void constraint(const Constraint& c) {
    const Body* b = known(c.body, c.place);
    if (b && b->model == BodyModel::surface) parts_.wrong(c.place, "holds a surface, which only rides on others");
    parts_.region(c.where, c.place);
    if (std::none_of(c.fixed.begin(), c.fixed.end(), [](bool f) { return f; }))
      parts_.wrong(c.place, "holds nothing; set an entry of fixed");
    if (!is_orthonormal(c.axes))
      parts_.wrong(c.place, "has axes that are no orthonormal rows; use unit vectors at right angles");
    if (c.motion) parts_.motion(*c.motion, c.place);
    parts_.schedule(c.schedule, c.place);
  }

  void load(const Load& l) {
    known(l.body, l.place);
    const int given = l.total_force.has_value() + l.total_torque.has_value() + l.force_per_node.has_value() +
                      l.traction.has_value() + l.pressure.has_value() + l.line_force.has_value();
    const int at_point = l.force.has_value() + l.torque.has_value();
    if (l.at.has_value() == l.where.has_value())
      parts_.wrong(l.place, "must act on a region (where) or at a point (at)");
    if (given + at_point == 0) parts_.wrong(l.place, "applies nothing");
    if ((l.at && given > 0) || (l.where && at_point > 0))
      parts_.wrong(l.place, "mixes what acts on a region with what acts at a point");
    for (const auto& v :
         {l.total_force, l.total_torque, l.force_per_node, l.force, l.torque, l.traction, l.line_force, l.at})
      if (v) parts_.finite(*v, l.place);
    if (l.pressure) parts_.finite(*l.pressure, l.place);
    if (l.where) parts_.region(*l.where, l.place);
    parts_.schedule(l.schedule, l.place);
  }

  void coupling(const Coupling& c) {
    if (!couplings_.insert(c.name).second || c.name.empty() || bodies_.contains(c.name))
      parts_.wrong(c.place, fmt::format("has the name \"{}\", which is empty or taken; give each its own", c.name));
    const Body* own = known(c.body, c.place);
    parts_.region(c.where, c.place);
    if (c.kind == CouplingKind::spring) {
      parts_.positive(c.stiffness, c.place, "stiffness");
      parts_.finite(c.point, c.place);
      if (c.direction) parts_.unit(*c.direction, c.place, "direction");
      return;
    }
    if (own) other(c.to, *own, c.to_place);
  }

  void probe(const Probe& p) {
    if (!probes_.insert(p.name).second || p.name.empty())
      parts_.wrong(p.place,
                   fmt::format("has the name \"{}\", which is empty or another probe's; give each its own", p.name));
    const Body* b = p.body ? known(*p.body, p.place) : nullptr;
    const bool at_points = p.quantity <= Quantity::stress;
    const bool on_nodes = p.quantity == Quantity::force || p.quantity == Quantity::moment;
    const bool tensor = p.quantity == Quantity::strain || p.quantity == Quantity::stress;
    if (at_points && p.at.empty()) parts_.wrong(p.at_place, "is missing; give a point of the body");
    if (!at_points && !p.at.empty()) parts_.wrong(p.at_place, "is not used by this quantity");
    if (on_nodes && !p.where) parts_.wrong(p.place, "needs a region (where)");
    if ((at_points || on_nodes || p.where) && !p.body) parts_.wrong(p.place, "needs a body");
    if (b && is_carrier(*b) && tensor) parts_.wrong(p.place, "asks for strain or stress of a body without matter");
    for (const Vec3d& X : p.at) parts_.finite(X, p.at_place);
    if (p.about) parts_.finite(*p.about, p.place);
    if (p.where) parts_.region(*p.where, p.place);
  }

  const Scene& scene_;
  std::map<std::string, const Body*> bodies_;
  std::set<std::string> couplings_, probes_;
  std::vector<Diagnostic> wrong_;
  CheckParts parts_;
};

}  // namespace

void check_specification(const Scene& scene) { Check(scene).run(); }

}  // namespace fascia
