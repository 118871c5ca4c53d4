#include "app/bench/command.hpp"
#include "app/compare/command.hpp"
#include "app/estimate/estimate.hpp"
#include "app/explain/explain.hpp"
#include "app/extremes/extremes.hpp"
#include "app/need/need.hpp"
#include "app/rerun.hpp"
#include "app/study/study.hpp"
#include "app/tools.hpp"
#include "app/tools_tag.hpp"
#include "app/tune/tune.hpp"
#include "app/verify/verify.hpp"

namespace fascia::app {
namespace {

std::unique_ptr<ErrorEstimate> make_estimate(const Simulation& simulation) {
  return std::make_unique<Estimate>(simulation);
}

std::vector<std::string> estimate_plan(const Simulation& simulation) { return plan_lines(plan_estimate(simulation)); }

constexpr Tools kTools{FASCIA_TOOLS_TAG, run_bench,     compare_command, explain_scene,  run_extremes,
                       rerun_result,     run_study,     run_tune,        verify_command, run_need,
                       check_need,       make_estimate, estimate_plan};

}  // namespace
}  // namespace fascia::app

/// The library looks this up in fascia-tools.so, by the name kToolsEntry.
extern "C" const fascia::app::Tools* fascia_tools() { return &fascia::app::kTools; }
