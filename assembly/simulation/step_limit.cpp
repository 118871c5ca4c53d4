#include "assembly/simulation/step_limit.hpp"

#include "assembly/simulation/places.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/index.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/solver/mechanical_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

constexpr double kDiffers = 1.5;  ///< a ratio that is told
constexpr double kMost = 0.05;    ///< part of the energy that strains must have where a point is blamed for it

/// A motion as a state, to first order.
State state_of(const Model& model, const std::vector<double>& motion) {
  State state = State::at_rest(model);
  const DofLayout& dofs = model.points.dofs;
  for (int node = 0; node < model.node_count(); ++node) {
    const double* d = motion.data() + dofs.begin(node);
    state.u[at(node)] = Vec3d{{d[0], d[1], d[2]}};
    state.D[at(node)] = frame_variation(dofs.kind(node), d + 3, Mat3d::identity());
  }
  return state;
}

double density_of(const ModelBody& body) { return body.volume() > 0 ? body.mass() / body.volume() : 0; }

/// Means over the model by volume.
struct Means {
  double volume = 0, length = 0, stiffness = 0, density = 0;

  void add(const BodyPoint& p, double weights_length, double rho) {
    volume += p.volume;
    length += p.volume * weights_length;
    stiffness += p.volume * p.wave_modulus();
    density += p.volume * rho;
  }
};

class Search {
 public:
  Search(const Simulation& s, const LimitingMotion& limit)
      : s_(s), limit_(limit), state_(state_of(s.model, limit.motion)) {
    for (std::size_t b = 0; b < s.bodies.size(); ++b) look(static_cast<int>(b));
  }

  /// Describes the point with most strain energy; where thin points have most of the motion, or no point much of the
  /// energy, of the one whose nodes move most.
  StepLimit found() const {
    const double total = 2 / std::pow(limit_.undamped / kStableMargin, 2);  // ω²/2
    const Candidate& best = strained_.energy > kMost * total || moved_.body < 0 ? strained_ : moved_;
    StepLimit out;
    if (best.body < 0) return out;
    const SimulatedBody& b = s_.bodies[at(best.body)];
    const BodyPoint& p = b.body->points()[best.point];
    const double rho = density_of(*b.body), stiffness = p.wave_modulus();
    out.body = best.body;
    out.point = best.point;
    out.share = std::min(1.0, strained_.energy / total);
    out.length = weight_length(b.body->attach_point(best.point));
    out.speed = rho > 0 ? std::sqrt(stiffness / rho) : 0;
    out.text =
        fmt::format("{} of body \"{}\": {} {}, waves of {:.3g} m/s (E = {}, {:.4g} kg/m3){}", point_name(b, best.point),
                    b.name, length_text(out.length), p.cell >= 0 ? "high" : "to the next frame", out.speed,
                    young_text(p), rho, differences(out.length, stiffness, rho));
    return out;
  }

 private:
  struct Candidate {
    int body = -1;
    std::size_t point = 0;
    double energy = 0;
  };

  static std::string young_text(const BodyPoint& p) { return pressure_text(p.young()); }

  void look(int index) {
    const ModelBody& body = *s_.bodies[at(index)].body;
    const double rho = density_of(body);
    for (std::size_t q = 0; q < body.points().size(); ++q) {
      const BodyPoint& p = body.points()[q];
      const Attachment a = body.attach_point(q);
      means_.add(p, weight_length(a), rho);
      double kinetic = 0;
      for (std::size_t k = 0; k < a.nodes.size(); ++k) kinetic += a.influences[k].w * limit_.kinetic[at(a.nodes[k])];
      if (kinetic > moved_.energy) moved_ = {index, q, kinetic};
      if (is_thin(p.law)) continue;
      const Mat3d H = field_at(a, state_).H, E = (H + transpose(H)) * 0.5;
      const double energy = p.volume * (0.5 * p.lambda * trace(E) * trace(E) + p.mu * contract(E, E));
      if (energy > strained_.energy) strained_ = {index, q, energy};
    }
  }

  /// Says why it is faster than the rest of the model.
  std::string differences(double length, double stiffness, double rho) const {
    std::vector<std::string> said;
    const double V = means_.volume;
    if (length * kDiffers * V < means_.length)
      said.push_back(fmt::format("{:.2g} of the mean size", length * V / means_.length));
    if (stiffness * V > kDiffers * means_.stiffness)
      said.push_back(fmt::format("{:.2g} times the mean stiffness", stiffness * V / means_.stiffness));
    if (rho * kDiffers * V < means_.density)
      said.push_back(fmt::format("{:.2g} of the mean density", rho * V / means_.density));
    if (limit_.undamped > kDiffers * limit_.step)
      said.push_back(fmt::format("without stiffness_damping the step would be {:.3g} s", limit_.undamped));
    return said.empty() ? "" : fmt::format("; {}", fmt::join(said, ", "));
  }

  const Simulation& s_;
  const LimitingMotion& limit_;
  State state_;
  Means means_;
  Candidate strained_, moved_;
};

}  // namespace

StepLimit step_limit(const Simulation& s, MechanicalSystem& system) {
  const LimitingMotion limit = limiting_motion(system, s.initial);
  if (limit.motion.empty()) return {};
  return Search(s, limit).found();
}

}  // namespace fascia
