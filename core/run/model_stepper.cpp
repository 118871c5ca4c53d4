#include "core/run/model_stepper.hpp"

#include "core/run/drivers_body.hpp"
#include "core/run/system_stepper.hpp"

namespace fascia {

namespace {

/// A step of the host, whose pose is its state.
class HostStep final : public ReachedStep {
 public:
  HostStep(MechanicalSystem& system, const State& pose, State& /*state*/, bool /*fetched*/) : step_(system, pose) {}
  InternalEnergy energy() const override { return step_.energy(); }
  const State& state() override { return step_.state(); }
  void read(const ReachedParts& parts, ReachedForces& out) override { step_.read(parts, out); }

 private:
  SystemStep step_;
};

}  // namespace

std::unique_ptr<ModelStepper> make_stepper(const Model& model, const State& start, ThreadPool& pool,
                                           const SolverSettings& settings, const SteppingSettings& stepping) {
  return std::make_unique<SystemStepper<MechanicalSystem, HostStep>>(model, start, settings, stepping, pool);
}

}  // namespace fascia
