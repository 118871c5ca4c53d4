#include "gpu/run/device_functions.hpp"

#include "gpu/interface_tag.hpp"
#include "gpu/run/loaded_module.hpp"

#include <atomic>
#include <cstdlib>
#include <filesystem>

namespace fascia::gpu {

namespace {

namespace fs = std::filesystem;

struct Loaded {
  const DeviceFunctions* functions = nullptr;
  std::string reason;
};

/// The one that kModuleVariable names; else beside the library or program that holds this function; of one that is
/// chosen by the processor (glibc-hwcaps/LEVEL), in the folder that all levels share.
fs::path module_file() {
  const char* named = std::getenv(kModuleVariable);
  if (named != nullptr && *named != '\0') return fs::absolute(named);
  const fs::path folder = file_of(reinterpret_cast<const void*>(&device_functions)).parent_path();
  const bool chosen = folder.parent_path().filename() == "glibc-hwcaps";
  return (chosen ? folder.parent_path().parent_path() : folder) / "fascia-cuda.so";
}

Loaded load() {
  const fs::path file = module_file();
  if (!fs::exists(file))
    return {nullptr, "this build has no CUDA backend: there is no " + file.string() +
                         (std::getenv(kModuleVariable) != nullptr
                              ? std::string(", which ") + kModuleVariable + " names"
                              : " (of the package fascia-cuda; in a checkout ./run builds it where there is a CUDA "
                                "toolkit)")};
  const LoadedModule module = load_module(file, kModuleEntry);
  if (module.entry == nullptr) return {nullptr, "the CUDA backend cannot be loaded: " + module.reason};
  const DeviceFunctions* functions = reinterpret_cast<ModuleEntry>(module.entry)();
  if (functions == nullptr || std::string(functions->build) != FASCIA_INTERFACE_TAG)
    return {nullptr, file.string() + " is of another build than this program: build the target " +
                         file.stem().string() + " again"};
  return {functions, ""};
}

const DeviceFunctions* linked = nullptr;              ///< see use_device_functions()
std::atomic<const DeviceFunctions*> loaded{nullptr};  ///< once something asked for them

/// @throws NoDevice
const DeviceFunctions& needed() {
  std::string reason;
  if (const DeviceFunctions* f = device_functions(reason)) return *f;
  throw NoDevice(reason + "; use --backend auto, or cpu");
}

}  // namespace

const DeviceFunctions* device_functions(std::string& reason) {
  if (linked != nullptr) return linked;
  static const Loaded found = load();
  loaded = found.functions;
  if (found.functions == nullptr) reason = found.reason;
  return found.functions;
}

const DeviceFunctions* device_functions_in_use() { return linked != nullptr ? linked : loaded.load(); }

bool device_module_exists() {
  std::error_code ignored;
  return linked != nullptr || fs::exists(module_file(), ignored);
}

void use_device_functions(const DeviceFunctions& functions) { linked = &functions; }

std::vector<int> find_devices(int count, std::string& reason) {
  const DeviceFunctions* f = device_functions(reason);
  return f == nullptr ? std::vector<int>{} : f->find_devices(count, reason);
}

void require_device() {
  std::string reason;
  if (!find_device(reason)) throw NoDevice(reason + "; use --backend auto, or cpu");
}

RunReport run_statics(const Model& model, State& state, const FactorFunction& factors, const SolverSettings& settings,
                      const StaticsSettings& statics, const DeviceObserver& observe) {
  return needed().run_statics(model, state, factors, settings, statics, observe);
}

RunReport run_implicit(const Model& model, State& state, const FactorFunction& factors, const SolverSettings& settings,
                       const DynamicsSettings& dynamics, const DeviceObserver& observe) {
  return needed().run_implicit(model, state, factors, settings, dynamics, observe);
}

RunReport run_explicit(const Model& model, State& state, const FactorFunction& factors, const SolverSettings& settings,
                       const ExplicitSettings& dynamics, const DeviceObserver& observe) {
  return needed().run_explicit(model, state, factors, settings, dynamics, observe);
}

std::unique_ptr<ModelStepper> make_stepper(const Model& model, const State& start, const SolverSettings& settings,
                                           const SteppingSettings& stepping) {
  return needed().make_stepper(model, start, settings, stepping);
}

DeviceEvaluation evaluate(const Model& model, const State& state, std::span<const double> factors,
                          const SolverSettings& settings, std::span<const double> direction) {
  return needed().evaluate(model, state, factors, settings, direction);
}

}  // namespace fascia::gpu
