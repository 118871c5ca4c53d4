#include "app/diagnosis/failure.hpp"

#include "app/scene/laws.hpp"
#include "assembly/simulation/matter.hpp"
#include "assembly/simulation/places.hpp"
#include "core/base/index.hpp"
#include "core/node/dof_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {

namespace {

constexpr double kCrushed = 0.1;  ///< det F
constexpr double kMuch = 0.5;     ///< of the largest share of a point

bool is_finite(const Mat3d& A) {
  double sum = 0;
  for (const auto& row : A.m)
    for (const double a : row) sum += a;
  return std::isfinite(sum);
}

bool is_finite(const Vec3d& v) { return std::isfinite(v[0] + v[1] + v[2]); }

/// Puts nodes without finite places back. @return  1 for each of them
std::vector<char> mend(State& state, const State& good) {
  std::vector<char> lost(state.u.size(), 0);
  for (std::size_t i = 0; i < lost.size(); ++i) {
    if (is_finite(state.u[i]) && is_finite(state.D[i])) continue;
    lost[i] = 1;
    state.u[i] = good.u[i];
    state.D[i] = good.D[i];
  }
  for (std::size_t i = 0; i < lost.size(); ++i)
    if (!is_finite(state.v[i]) || !is_finite(state.Q_dot[i])) {
      state.v[i] = good.v[i];
      state.Q_dot[i] = good.Q_dot[i];
    }
  if (!std::all_of(state.memory.begin(), state.memory.end(), [](double S) { return std::isfinite(S); }))
    state.memory = good.memory;
  return lost;
}

/// Each node's part of the squared residual, torques divided by the length of their part.
std::vector<double> residual_shares(const Model& model, std::vector<double> gradient) {
  const DofFilter filter(model);
  filter.to_local(gradient);
  filter.clear_fixed(gradient);
  std::vector<double> shares(at(model.node_count()), 0.0);
  const DofLayout& dofs = model.points.dofs;
  for (int node = 0; node < model.node_count(); ++node) {
    const double length = model.points.part_length[at(model.points.node_part[at(node)])];
    for (int k = 0; k < dofs.size(node); ++k) {
      const double r = gradient[at(dofs.begin(node) + k)] / (k < 3 ? 1 : length);
      shares[at(node)] += r * r;
    }
  }
  return shares;
}

std::vector<double> kinetic_shares(const Model& model, const State& state) {
  std::vector<double> shares;
  for (std::size_t i = 0; i < state.v.size(); ++i) {
    const FrameInertia& m = model.inertia[i];
    const Mat3d& W = state.Q_dot[i];
    shares.push_back(m.mass * squared_norm(state.v[i]) + 2 * dot(state.v[i], W * m.first) + contract(W * m.second, W));
  }
  return shares;
}

/// Parts of the whole. Where some have no finite value, these have it all.
void normalise(std::vector<double>& shares) {
  const bool finite = std::all_of(shares.begin(), shares.end(), [](double s) { return std::isfinite(s); });
  double sum = 0;
  for (double& s : shares) {
    if (!finite) s = std::isfinite(s) ? 0 : 1;
    sum += s = std::max(0.0, s);
  }
  for (double& s : shares) s = sum > 0 ? s / sum : 0;
}

class Search {
 public:
  Search(const Simulation& s, const FailedState& failed, const State& good) : s_(s), dynamic_(failed.gradient.empty()) {
    found_.state = failed.state;
    lost_ = mend(found_.state, good);
    shares_ = dynamic_ ? kinetic_shares(s.model, failed.state) : residual_shares(s.model, failed.gradient);
    normalise(shares_);
    for (std::size_t b = 0; b < s.bodies.size(); ++b) look(static_cast<int>(b));
    mark();
    describe(failed.step);
  }

  Failure found() { return std::move(found_); }

 private:
  void look(int index) {
    const SimulatedBody& b = s_.bodies[at(index)];
    FailureMarks& m = found_.marks.emplace_back();
    for (const int node : b.node_ids) m.share.push_back(shares_[at(node)]);
    const std::size_t count = b.body->points().size();
    m.suspect.assign(count, 0);
    std::vector<double>& loads = load_.emplace_back(count, 0.0);
    for (std::size_t q = 0; q < count; ++q) {
      const Attachment a = b.body->attach_point(q);
      bool lost = false;
      for (std::size_t k = 0; k < a.nodes.size(); ++k) {
        loads[q] += shares_[at(a.nodes[k])] * std::abs(a.influences[k].w);
        lost = lost || lost_[at(a.nodes[k])] != 0;
      }
      const bool solid = !is_thin(b.body->points()[q].law);
      const double J = determinant(Mat3d::identity() + field_at(a, found_.state).H);
      m.volume.push_back(lost || !std::isfinite(J) ? 0.0 : J);
      if ((solid || lost) && (worst_.body < 0 || m.volume[q] < least())) worst_ = {index, q};
      if (most_.body < 0 || loads[q] > load_[at(most_.body)][most_.point]) most_ = {index, q};
    }
  }

  double least() const { return found_.marks[at(worst_.body)].volume[worst_.point]; }

  /// Marks what is inside out, else what is crushed, else what has most of the share.
  void mark() {
    crushed_ = worst_.body >= 0 && least() < kCrushed;
    if (!crushed_) worst_ = most_;
    if (worst_.body < 0) return;
    const double limit = crushed_ && least() <= 0 ? 0.0 : kCrushed;
    const double much = kMuch * load_[at(most_.body)][most_.point];
    for (std::size_t b = 0; b < found_.marks.size(); ++b)
      for (std::size_t q = 0; q < found_.marks[b].suspect.size(); ++q) {
        const bool solid = !is_thin(s_.bodies[b].body->points()[q].law);
        const double J = found_.marks[b].volume[q];
        const bool suspect = crushed_ ? (solid && J <= limit) || J == 0 : load_[b][q] >= much && much > 0;
        found_.marks[b].suspect[q] = suspect ? 1 : 0;
      }
  }

  void describe(int step) {
    found_.summary = {{"step", step}, {"body", nullptr}};
    if (worst_.body < 0) return;
    const SimulatedBody& b = s_.bodies[at(worst_.body)];
    const FailureMarks& m = found_.marks[at(worst_.body)];
    const auto suspects = std::count(m.suspect.begin(), m.suspect.end(), 1);
    const double J = m.volume[worst_.point], share = share_at(b, worst_.point);
    const char* quantity = crushed_ ? "det F" : dynamic_ ? "kinetic energy" : "residual";
    std::string& text = found_.text;
    text = fmt::format("worst at {} of body \"{}\": ", point_name(b, worst_.point), b.name);
    if (crushed_)
      text += fmt::format("its volume is {:.3g} of that at rest ({} of {} integration points are {})", J, suspects,
                          m.suspect.size(), J <= 0 ? "turned inside out" : "crushed");
    else
      text += fmt::format("{:.0f} % of the {} is at its nodes", 100 * share, quantity);
    text += remedy(s_.scene.bodies[at(worst_.body)], b.body->points()[worst_.point]);
    // The law itself is the cause where it gives way, however good the mesh and the steps.
    const std::string cause = crushed_ ? "" : yielding_sentence(s_, at(worst_.body), found_.state);
    if (!cause.empty()) text += "; " + cause;
    const Vec3d X = point_place(b, worst_.point);
    const int cell = b.groups() == nullptr ? -1 : b.body->points()[worst_.point].cell;
    found_.summary["body"] = b.name;
    if (cell >= 0) found_.summary["element"] = b.body->cell_number(cell);
    found_.summary["at"] = {X[0], X[1], X[2]};
    found_.summary["quantity"] = quantity;
    found_.summary["value"] = crushed_ ? J : share;
    found_.summary["suspects"] = suspects;
  }

  double share_at(const SimulatedBody& b, std::size_t point) const {
    double sum = 0;
    for (const int node : b.body->attach_point(point).nodes) sum += shares_[at(node)];
    return std::min(1.0, sum);
  }

  /// In the words of the scene.
  std::string remedy(const Body& body, const BodyPoint& p) const {
    const Material* material = material_of(body, p);
    const std::string name = material == nullptr || material->name.empty() ? "" : "materials." + material->name + ".";
    const bool whole = body.formulation == Formulation::large_strain;
    if (crushed_ && p.law == Law::st_venant_kirchhoff && whole && material != nullptr)
      return fmt::format("; {}law = \"neo-hookean\" resists that", name);
    if (crushed_ && !whole)
      return fmt::format("; bodies.{}: leave formulation out, and use law = \"neo-hookean\"", body.name);
    if (is_shell(body))
      return fmt::format("; look at bodies.{}.thickness, its mesh there, and what acts there", body.name);
    if (crushed_)
      return fmt::format(
          "; a stiffer {}{}, smaller loads or motions there, or {}", name, stiffness_key(p.law),
          is_mesh_model(body) ? "a mesh without flat elements there" : "other bodies." + body.name + ".frames");
    return "";
  }

  struct At {
    int body = -1;
    std::size_t point = 0;
  };

  const Simulation& s_;
  Failure found_;
  bool dynamic_, crushed_ = false;
  std::vector<char> lost_;
  std::vector<double> shares_;             ///< of the nodes of the model
  std::vector<std::vector<double>> load_;  ///< of the points of each body: shares of their nodes by weight
  At worst_, most_;
};

}  // namespace

Failure find_failure(const Simulation& s, const FailedState& failed, const State& good) {
  return Search(s, failed, good).found();
}

}  // namespace fascia::app
