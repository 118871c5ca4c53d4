#include "assembly/specification/check_parts.hpp"

#include "core/physics/solid_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia {

bool is_orthonormal(const Mat3d& axes) {
  constexpr double kWritten = 1e-5;  // six digits of each number
  const Mat3d error = times_transpose(axes, axes) - Mat3d::identity();
  return contract(error, error) < kWritten * kWritten;
}

void CheckParts::finite(double value, const Place& place) {
  if (!std::isfinite(value)) wrong(place, "has a number that is not finite");
}
void CheckParts::finite(const Vec3d& v, const Place& place) { finite(v[0] + v[1] + v[2], place); }
void CheckParts::positive(double value, const Place& place, const char* name) {
  if (!(value > 0 && std::isfinite(value)))
    wrong(place, fmt::format("{} = {} is out of range; must be above 0", name, value));
}
void CheckParts::at_least_zero(double value, const Place& place, const char* name) {
  if (!(value >= 0 && std::isfinite(value)))
    wrong(place, fmt::format("{} = {} is out of range; must be at least 0", name, value));
}
void CheckParts::unit(const Vec3d& v, const Place& place, const char* name) {
  if (!(std::abs(norm(v) - 1) < 1e-5)) wrong(place, fmt::format("{} has the length {}; must be 1", name, norm(v)));
}
void CheckParts::counts(const std::vector<int>& count, std::size_t size, int least, const Place& place) {
  if (count.size() != size) return wrong(place, fmt::format("has {} numbers; must have {}", count.size(), size));
  for (const int n : count)
    if (n < least) wrong(place, fmt::format("has the number {}; must be at least {}", n, least));
}

void CheckParts::region(const Region& r, const Place& place, int depth) {
  constexpr int kDeepest = 64;
  if (depth > kDeepest) return wrong(place, "has regions within regions, deeper than 64");
  if (const auto* box = std::get_if<BoxRegion>(&r.shape))
    for (int k = 0; k < 3; ++k)
      if (!(box->min[k] <= box->max[k])) return wrong(place, "has a box whose min is not below max");
  if (const auto* ball = std::get_if<SphereRegion>(&r.shape)) {
    positive(ball->radius, place, "radius");
    finite(ball->center, place);
  }
  if (const auto* cylinder = std::get_if<CylinderRegion>(&r.shape)) {
    positive(cylinder->radius, place, "radius");
    if (!(norm(cylinder->to - cylinder->from) > 0)) wrong(place, "has a cylinder without length");
  }
  if (const auto* half = std::get_if<HalfspaceRegion>(&r.shape); half && !(norm(half->normal) > 0))
    wrong(place, "has a half-space without a normal");
  if (const auto* near = std::get_if<NearestRegion>(&r.shape)) finite(near->point, place);
  const auto parts_of = [&](const std::vector<Region>& parts) {
    if (parts.empty()) wrong(place, "has a region that joins no regions");
    for (const Region& part : parts) region(part, place, depth + 1);
  };
  if (const auto* all = std::get_if<AllOfRegion>(&r.shape)) parts_of(all->parts);
  if (const auto* any = std::get_if<AnyOfRegion>(&r.shape)) parts_of(any->parts);
  if (const auto* no = std::get_if<NotRegion>(&r.shape)) {
    if (!no->part) return wrong(place, "has a region of nothing: not without a part");
    region(*no->part, place, depth + 1);
  }
}

void CheckParts::schedule(const Schedule& s, const Place& place) {
  at_least_zero(s.over, place, "over");
  if (const auto* sine = std::get_if<SineProfile>(&s.profile)) positive(sine->period, place, "period");
  const auto* table = std::get_if<TableProfile>(&s.profile);
  if (!table) return;
  if (table->points.empty()) wrong(place, "has a table without rows");
  for (std::size_t k = 0; k < table->points.size(); ++k) {
    finite(table->points[k][0] + table->points[k][1], place);
    if (k > 0 && !(table->points[k][0] > table->points[k - 1][0]))
      wrong(place, "has a table whose times do not ascend");
  }
}

void CheckParts::motion(const Motion& m, const Place& place) {
  finite(m.translate, place);
  finite(m.center, place);
  finite(m.angle, place);
  if (!(norm(m.axis) > 0 && std::isfinite(norm(m.axis)))) wrong(place, "turns about an axis without a direction");
}

void CheckParts::material(const Material& m, bool small) {
  positive(m.mu, m.place, "mu");
  if (!(3 * m.lambda + 2 * m.mu > 0) || !std::isfinite(m.lambda))
    wrong(m.place, fmt::format("lambda = {} is out of range; must be above -2/3 mu", m.lambda));
  at_least_zero(m.mass_damping, m.place, "mass_damping");
  at_least_zero(m.stiffness_damping, m.place, "stiffness_damping");
  if (!is_of_points(m.law)) return wrong(m.place, "has a law that is none of a material; take one of large strain");
  if (small && m.law != Law::st_venant_kirchhoff)
    wrong(m.place, "has a law that shells, thin bodies and formulations of small strain do not take");
  if (static_cast<int>(m.own.size()) != own_constant_count(m.law))
    wrong(m.place, fmt::format("has {} constants of its own; its law has {}", m.own.size(), own_constant_count(m.law)));
  for (const double constant : m.own) finite(constant, m.place);
  fibres(m);
}

void CheckParts::fibres(const Material& m) {
  for (const Fibres& f : m.fibres) {
    if (const auto* straight = std::get_if<StraightFibres>(&f.field)) unit(straight->direction, f.place, "direction");
    const auto* wound = std::get_if<WoundFibres>(&f.field);
    if (wound == nullptr) continue;
    unit(wound->axis, f.place, "axis");
    finite(wound->point, f.place);
    finite(wound->angle, f.place);
  }
  if (!m.activation) return;
  const Activation& a = *m.activation;
  positive(a.stress, a.place, "stress");
  schedule(a.schedule, a.place);
  if (a.fibres >= m.fibres.size())
    wrong(a.place, fmt::format("acts along family {} of fibres; the material has {}", a.fibres, m.fibres.size()));
}

void CheckParts::fluid(const Fluid& f) {
  if (f.pressure.has_value() == f.bulk_modulus.has_value())
    wrong(f.place, "must have a pressure or a bulk modulus, not both");
  if (f.pressure) finite(*f.pressure, f.place);
  if (f.bulk_modulus) positive(*f.bulk_modulus, f.place, "bulk_modulus");
  if (f.volume) positive(*f.volume, f.place, "volume");
  at_least_zero(f.density, f.place, "density");
  schedule(f.schedule, f.place);
}

void CheckParts::domain(const Body& b) {
  const Place& place = b.domain_place;
  if (const auto* box = std::get_if<BoxDomain>(&b.domain))
    for (int k = 0; k < 3; ++k)
      if (!(box->min[k] < box->max[k]) || !std::isfinite(box->max[k] - box->min[k]))
        return wrong(place, "has a box whose min is not below max");
  if (const auto* c = std::get_if<CylinderDomain>(&b.domain)) {
    positive(c->radius, place, "radius");
    if (!(norm(c->to - c->from) > 0)) wrong(place, "has a cylinder without length");
  }
  if (const auto* e = std::get_if<EllipsoidDomain>(&b.domain)) {
    finite(e->center, place);
    for (int k = 0; k < 3; ++k) positive(e->radii[k], place, "a radius");
  }
  if (const auto* r = std::get_if<RectangleDomain>(&b.domain))
    if (!(norm(cross(r->edge_u, r->edge_v)) > 0)) wrong(place, "has a rectangle without area");
  if (const auto* line = std::get_if<LineDomain>(&b.domain))
    if (!(norm(line->to - line->from) > 0)) wrong(place, "has a line without length");
  if (const auto* ring = std::get_if<AnnulusDomain>(&b.domain))
    if (!(norm(ring->normal) > 0) || !(ring->inner > 0) || !(ring->outer > ring->inner))
      wrong(place, "has a ring without a normal, or whose outer radius is not above the inner one");
  if (const auto* file = std::get_if<FileDomain>(&b.domain); file && (file->refine < 0 || file->refine > 6))
    wrong(file->refine_place, "is out of range; must be from 0 to 6");
  positive(b.transform.scale, place, "the transform's scale");
  finite(b.transform.translate, place);
  finite(b.transform.angle, place);
  if (!(norm(b.transform.axis) > 0)) wrong(place, "is turned about an axis without a direction");
}

void CheckParts::solver(const Solver& s) {
  const auto one_of = [&](const std::string& value, std::initializer_list<const char*> words, const char* name) {
    if (std::find(words.begin(), words.end(), value) == words.end())
      wrong(s.place, fmt::format("{} = \"{}\" is none that there is", name, value));
  };
  one_of(s.backend, {"auto", "cpu", "cuda"}, "backend");
  one_of(s.precision, {"double", "mixed", "single"}, "precision");
  const auto tolerance = [&](double value, const char* name) {
    if (!(value > 0 && value < 1))
      wrong(s.place, fmt::format("{} = {} is out of range; must be in (0, 1)", name, value));
  };
  tolerance(s.newton_tolerance, "newton_tolerance");
  tolerance(s.linear_tolerance, "linear_tolerance");
  if (s.newton_max_iterations < 1 || s.linear_max_iterations < 1 || s.load_steps < 0 || s.gpus < 1 || s.threads < 0)
    wrong(s.place, "has a number of iterations, load steps, GPUs or threads that is out of range");
  if (!(s.imperfection >= 0 && s.imperfection < 1) || (s.imperfection > 0 && s.kind != SolverKind::statics))
    wrong(s.imperfection_place, "must be a part of the largest body, from 0 to 1, in statics");
}

}  // namespace fascia
