#pragma once

#include "app/verify/certificate.hpp"
#include "app/verify/runs.hpp"

#include <string>

namespace fascia::app {

/// All of a verification.
struct Verification {
  Certificate certificate;
  RunSettings settings;
  Registry runs;
  std::vector<RunOutcome> outcomes;  ///< of the runs; empty while they run
  std::size_t long_left = 0;         ///< runs left out because they take long
  double seconds = 0;
  bool interrupted = false;
};

/// How many cases ended how.
struct Counts {
  std::size_t passed = 0, failed = 0, skipped = 0;
  std::size_t repeated = 0, unequal = 0;  ///< repetitions
  std::size_t not_made = 0;               ///< runs, by an interruption
  double processor_seconds = 0;
  std::size_t all() const { return passed + failed + skipped; }
  bool good() const { return failed == 0 && unequal == 0 && not_made == 0; }
};
Counts count(const Verification& v);

/// verify.json: everything, for machines.
std::string json_text(const Verification& v);

/// A line a case.
std::string csv_of(const Verification& v);

/// A line for each case that failed or was skipped, and for each repetition that was not equal; then the totals.
std::string text_of(const Verification& v);

/// The page for people, complete in itself.
std::string html_of(const Verification& v, const VerifyDirectory& directory);

/// docs/validation.md: every case with its reference, source and allowance, and where it was run its value and error.
/// Nothing in it depends on the machine or the time.
/// @param outcomes  of the runs, or none
std::string validation_page(const Registry& runs, const std::vector<RunOutcome>& outcomes);

/// A value to six digits, with its unit: "0.150441 m".
std::string with_unit(double value, const std::string& unit);
/// An error, or what is allowed: of the reference in percent, "-0.36 %", "1e-12 %", or with its unit.
std::string error_text(double error, const Allowed& kind, const std::string& unit);

}  // namespace fascia::app
