#pragma once

#include "app/run/run_scene.hpp"

#include <memory>
#include <string>
#include <vector>

/// Commands beside `run`, `check` and `list`, and what a run asks of their code: a module, fascia-tools.so, that is
/// loaded when one is asked for. A plain run waits neither for its compiler nor for the loader.
namespace fascia {
struct Scene;
struct Simulation;
}  // namespace fascia

namespace fascia::app {

class ErrorEstimate;
struct BenchOptions;
struct CompareOptions;
struct ExplainOptions;
struct ExtremesOptions;
struct RerunOptions;
struct StudyOptions;
struct TuneOptions;
struct VerifyOptions;

struct Tools {
  const char* build;  ///< FASCIA_TOOLS_TAG: builds whose headers differ must not exchange modules
  int (*bench)(const BenchOptions&);
  int (*compare)(const CompareOptions&);
  int (*explain)(const ExplainOptions&);
  int (*extremes)(const ExtremesOptions&);
  int (*rerun)(const RerunOptions&);
  int (*study)(const StudyOptions&);
  int (*tune)(const TuneOptions&);
  int (*verify)(const VerifyOptions&);
  int (*run_need)(const RunOptions&, const Scene&);
  int (*check_need)(const RunOptions&, const Scene&);
  std::unique_ptr<ErrorEstimate> (*make_estimate)(const Simulation&);
  std::vector<std::string> (*estimate_plan)(const Simulation&);  ///< what it would run, a line each
};

/// The module's, loaded at the first call. From any thread.
/// @throws FileError  where it is not there, or is of another build
const Tools& tools();

/// The name by which the module hands them out, of type ToolsEntry.
inline constexpr const char* kToolsEntry = "fascia_tools";
using ToolsEntry = const Tools* (*)();

}  // namespace fascia::app
