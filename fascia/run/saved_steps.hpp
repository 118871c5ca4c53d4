#pragma once

#include "assembly/simulation/simulation.hpp"
#include "core/run/drivers.hpp"
#include "core/solver/mechanical_system.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fascia {

/// Says which steps of a run are saved: of dynamics every so many seconds or steps, 25 a simulated second otherwise,
/// and the last.
class SaveRule {
 public:
  SaveRule(const Output& output, bool statics)
      : every_(output.every), every_steps_(output.every_steps), statics_(statics) {
    if (!statics && every_ == 0 && every_steps_ == 0) every_ = kDefaultEvery;
  }
  bool save(const StepInfo& step) const {
    if (step.progress >= 1) return true;
    if (every_steps_ > 0) return step.step % every_steps_ == 0;
    if (statics_ || every_ <= 0) return false;
    return count(step) > saved_;
  }
  /// A step that was to be saved is.
  void note(const StepInfo& step) {
    if (every_ > 0) saved_ = std::max(saved_, count(step));
  }

 private:
  double count(const StepInfo& step) const { return std::floor(step.time / every_ * (1 + 1e-9)); }

  double every_;
  int every_steps_;
  bool statics_;
  double saved_ = 0;
};

/// A state at which a system of the processor stands, where anything of it is needed.
class StandingState final : public ReachedStep {
 public:
  StandingState(std::optional<MechanicalSystem>& system, const State& state) : system_(system), state_(state) {}
  InternalEnergy energy() const override { return system_ ? system_->internal_energy() : InternalEnergy{}; }
  const State& state() override { return state_; }
  void read(const ReachedParts& parts, ReachedForces& out) override {
    if (system_ && parts.any()) system_->read(parts, state_, out);
  }

 private:
  std::optional<MechanicalSystem>& system_;
  const State& state_;
};

}  // namespace fascia
