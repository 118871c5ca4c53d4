#pragma once

#include "app/verify/cases.hpp"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

namespace fascia::app {

enum class Verdict { passed, failed, skipped };

const char* name_of(Verdict verdict);

/// How one case ended.
struct CaseOutcome {
  Verdict verdict = Verdict::skipped;
  std::string reason;           ///< of what did not pass
  std::optional<double> value;  ///< computed
  /// (value − reference) / reference: negative is too small; where an absolute error is allowed, value − reference.
  double error = 0;
};

/// Takes a case's value out of the summary of its run and judges it: within what is allowed it passed.
/// @param summary  of a run that converged
CaseOutcome judge(const VerificationCase& c, const nlohmann::ordered_json& summary);

}  // namespace fascia::app
