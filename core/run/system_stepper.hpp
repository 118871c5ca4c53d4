#pragma once

#include "core/run/implicit_stepper.hpp"
#include "core/run/model_stepper.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

namespace fascia {

/// A stepper by a system, for the files that instantiate it.
///
/// @tparam System   a MechanicalSystem, or one of the same functions on another processor
/// @tparam Reached  ReachedStep of such a system: Reached(system, pose, state of the host, whether that is fetched)
template <class System, class Reached>
class SystemStepper final : public ModelStepper {
 public:
  using Pose = typename System::Pose;

  /// @param arguments  of the system, behind the model and before the settings
  template <class... Arguments>
  SystemStepper(const Model& model, const State& start, const SolverSettings& settings,
                const SteppingSettings& stepping, Arguments&... arguments)
      : model_(model),
        settings_(settings),
        stepping_(stepping),
        make_system_(
            [this, &model, &arguments...] { return std::make_unique<System>(model, arguments..., settings_); }),
        system_(make_system_()),
        implicit_(std::in_place, *system_, settings_, stepping.scheme),
        state_(start) {
    if constexpr (!kOnHost) pose_ = Pose(start);
  }

  RunReport step(const FactorFunction& factors, double dt) override {
    system_->restart_motions();
    looked_ = false;
    const double start = pose().time;
    const std::vector<double> pressures = system_->reached_pressures();
    RunReport run;
    try {
      if (stepping_.statics) {
        before_ = pose();
        run = run_statics(*system_, pose(), factors, settings_, {stepping_.load_steps, start, start + dt}, {});
      } else {
        implicit_->step(pose(), factors, start + dt, dt, run);
      }
    } catch (...) {
      give_up(factors(start), pressures);
      throw;
    }
    reached_ = run.status == RunStatus::converged;
    if (!reached_) give_up(factors(start), pressures);
    fetched_ = kOnHost;
    return run;
  }

  std::string warm_up(const FactorFunction& factors, double dt) override {
    if (stepping_.statics) return "";
    system_->restart_motions();
    tried_ = dt;
    return implicit_->warm_up(pose(), factors, pose().time + dt, dt).message;
  }

  double time() const override {
    if constexpr (kOnHost)
      return state_.time;
    else
      return pose_.time;
  }

  const State& state() override {
    if constexpr (!kOnHost)
      if (!std::exchange(fetched_, true)) pose_.download(state_);
    return state_;
  }

  void read(const FactorFunction& factors, const ReachedParts& parts, ReachedForces& out) override {
    if (!std::exchange(looked_, true)) {
      if (reached_ && !stepping_.statics) {
        implicit_->look_back(pose());
      } else if (!reached_) {
        system_->set_factors(factors(pose().time));
        system_->look_at(pose(), 0);
      }
    }
    state();
    Reached step(*system_, pose(), state_, true);
    step.read(parts, out);
  }

  void model_changed(const FactorFunction& factors) override {
    SteppingSnapshot here{state(), {}, system_->reached_pressures()};
    State grown = State::at_rest(model_);
    const auto nodes = here.state.u.size();
    for (std::size_t i = 0; i < nodes; ++i) {
      grown.u[i] = here.state.u[i];
      grown.v[i] = here.state.v[i];
      grown.D[i] = here.state.D[i];
      grown.Q_dot[i] = here.state.Q_dot[i];
    }
    grown.turned = here.state.turned;
    grown.time = here.state.time;
    grown.factors = here.state.factors;
    if (here.state.memory.size() == model_.points.memory.size()) grown.memory = here.state.memory;
    here.state = std::move(grown);
    std::unique_ptr<System> anew = make_system_();
    implicit_.reset();
    system_ = std::move(anew);
    implicit_.emplace(*system_, settings_, stepping_.scheme);
    restore(here, factors);
    if (tried_ > 0) warm_up(factors, tried_);
  }

  SteppingSnapshot snapshot(const FactorFunction& factors) override {
    SteppingSnapshot out{state(), {}, system_->reached_pressures()};
    if constexpr (kOnHost)
      out.memory = implicit_->memory();
    else
      out.memory = implicit_->memory().downloaded();
    begin_afresh(out, factors);
    return out;
  }

  void restore(const SteppingSnapshot& snapshot, const FactorFunction& factors) override {
    state_ = snapshot.state;
    if constexpr (!kOnHost) pose_.upload(state_);
    fetched_ = true;
    begin_afresh(snapshot, factors);
  }

 private:
  static constexpr bool kOnHost = std::is_same_v<Pose, State>;
  struct Nothing {};

  Pose& pose() {
    if constexpr (kOnHost)
      return state_;
    else
      return pose_;
  }

  /// Forgets a step that failed. @param pressures  of fluids, before it
  void give_up(const std::vector<double>& factors, const std::vector<double>& pressures) {
    if (stepping_.statics) pose() = before_;
    system_->begin_afresh(factors, pressures);
    reached_ = false;
  }

  void begin_afresh(const SteppingSnapshot& from, const FactorFunction& factors) {
    implicit_->begin_afresh(typename System::Memory(from.memory));
    system_->begin_afresh(factors(from.state.time), from.pressures);
    reached_ = looked_ = false;
  }

  const Model& model_;
  SolverSettings settings_;
  SteppingSettings stepping_;
  std::function<std::unique_ptr<System>()> make_system_;
  std::unique_ptr<System> system_;
  std::optional<ImplicitStepper<System>> implicit_;
  State state_;
  [[no_unique_address]] std::conditional_t<kOnHost, Nothing, Pose> pose_;
  Pose before_;           ///< of statics: at the start of the last step
  bool reached_ = false;  ///< the system stands at the end of a step
  bool looked_ = false;   ///< its gradient is what acts at the state
  bool fetched_ = true;   ///< the host has the state
  double tried_ = 0;      ///< length of the step that warms up [s]; 0: none does
};

}  // namespace fascia
