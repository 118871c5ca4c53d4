#include "app/verify/report.hpp"

#include "app/report/csv.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const VerificationCase& c, const CaseOutcome& outcome) {
  Json j;
  j["name"] = c.name;
  j["title"] = c.title;
  j["value"] = outcome.value ? Json(*outcome.value) : Json(nullptr);
  j["reference"] = c.value;
  j["unit"] = c.unit;
  j["error"] = outcome.value ? Json(outcome.error) : Json(nullptr);
  j["allowed"] = c.allowed.error;
  j["relative"] = c.allowed.relative;
  j["uncertainty"] = c.uncertainty;
  j["source"] = c.source;
  j["why"] = c.why;
  j["verdict"] = name_of(outcome.verdict);
  j["reason"] = outcome.reason;
  return j;
}

Json json_of(const VerificationRun& run, const RunOutcome& outcome) {
  Json j;
  j["name"] = run.name;
  j["title"] = run.title;
  j["topic"] = run.topic;
  j["features"] = run.features;
  j["status"] = outcome.status;
  j["message"] = outcome.message;
  j["command"] = outcome.command;
  j["seconds"] = outcome.seconds;
  j["processor_seconds"] = outcome.processor_seconds;
  j["repetitions"] = Json::array();
  for (const Repetition& r : outcome.repetitions)
    j["repetitions"].push_back({{"threads", r.threads}, {"equal", r.equal}, {"difference", r.difference}});
  j["cases"] = Json::array();
  for (std::size_t c = 0; c < run.cases.size(); ++c) j["cases"].push_back(json_of(run.cases[c], outcome.cases[c]));
  return j;
}

std::string line_of(const VerificationCase& c, const CaseOutcome& outcome) {
  const std::string value =
      outcome.value ? fmt::format("{}; reference {}, error {}, allowed {}: ", with_unit(*outcome.value, c.unit),
                                  with_unit(c.value, c.unit), error_text(outcome.error, c.allowed, c.unit),
                                  error_text(c.allowed.error, c.allowed, c.unit))
                    : "";
  return fmt::format("{}: {}: {}{}\n", name_of(outcome.verdict), c.name, value, outcome.reason);
}

std::string plural(std::size_t n, const char* one) { return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s"); }

}  // namespace

std::string with_unit(double value, const std::string& unit) {
  return unit.empty() || unit == "1" || unit == "-" ? fmt::format("{:.6g}", value)
                                                    : fmt::format("{:.6g} {}", value, unit);
}

std::string error_text(double error, const Allowed& kind, const std::string& unit) {
  return kind.relative ? fmt::format("{:.2g} %", 100 * error)
                       : with_unit(std::stod(fmt::format("{:.2g}", error)), unit);
}

Counts count(const Verification& v) {
  Counts counts;
  for (const RunOutcome& run : v.outcomes) {
    counts.processor_seconds += run.processor_seconds;
    if (!run.done) ++counts.not_made;
    for (const CaseOutcome& c : run.cases)
      ++(c.verdict == Verdict::passed ? counts.passed : c.verdict == Verdict::failed ? counts.failed : counts.skipped);
    counts.repeated += run.repetitions.size();
    counts.unequal += static_cast<std::size_t>(
        std::count_if(run.repetitions.begin(), run.repetitions.end(), [](const Repetition& r) { return !r.equal; }));
  }
  return counts;
}

std::string json_text(const Verification& v) {
  const Counts counts = count(v);
  Json j;
  j["fascia"] = v.certificate.machine.fascia;
  j["status"] = v.outcomes.empty() ? "running" : v.interrupted ? "interrupted" : counts.good() ? "passed" : "failed";
  j["cases"] = {{"passed", counts.passed}, {"failed", counts.failed}, {"skipped", counts.skipped}};
  j["determinism"] = {{"repetitions", counts.repeated}, {"unequal", counts.unequal}};
  j["long_runs_left_out"] = v.long_left;
  j["backend"] = v.settings.backend ? Json(*v.settings.backend) : Json("of each scene");
  j["jobs"] = v.settings.jobs;
  j["time_limit"] = v.settings.time_limit;
  j["seconds"] = v.seconds;
  j["processor_seconds"] = counts.processor_seconds;
  j["certificate"] = json_of(v.certificate);
  j["runs"] = Json::array();
  for (std::size_t r = 0; r < v.outcomes.size(); ++r) j["runs"].push_back(json_of(v.runs[r], v.outcomes[r]));
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";  // names of files may be no UTF-8
}

std::string csv_of(const Verification& v) {
  std::string text =
      "run,case,title,unit,value,reference,uncertainty,error,allowed,relative,verdict,reason,source,run_seconds\n";
  for (std::size_t r = 0; r < v.outcomes.size(); ++r)
    for (std::size_t i = 0; i < v.runs[r].cases.size(); ++i) {
      const VerificationCase& c = v.runs[r].cases[i];
      const CaseOutcome& outcome = v.outcomes[r].cases[i];
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{:.3f}\n", v.runs[r].name, c.name, csv_cell(c.title),
                      csv_cell(c.unit), outcome.value ? fmt::format("{}", *outcome.value) : "", c.value, c.uncertainty,
                      outcome.value ? fmt::format("{:.6g}", outcome.error) : "", c.allowed.error, c.allowed.relative,
                      name_of(outcome.verdict), csv_cell(outcome.reason), csv_cell(c.source), v.outcomes[r].seconds);
    }
  return text;
}

std::string text_of(const Verification& v) {
  const Counts counts = count(v);
  std::string text;
  for (const Verdict verdict : {Verdict::skipped, Verdict::failed})
    for (std::size_t r = 0; r < v.outcomes.size(); ++r)
      for (std::size_t c = 0; c < v.runs[r].cases.size(); ++c)
        if (v.outcomes[r].cases[c].verdict == verdict && v.outcomes[r].done)
          text += line_of(v.runs[r].cases[c], v.outcomes[r].cases[c]);
  for (std::size_t r = 0; r < v.outcomes.size(); ++r) {
    for (const Repetition& again : v.outcomes[r].repetitions)
      if (!again.equal)
        text += fmt::format("not equal: {} again on {}: {}\n", v.runs[r].name,
                            plural(static_cast<std::size_t>(again.threads), "thread"), again.difference);
  }
  text += fmt::format("{} of {}: {} passed, {} failed, {} skipped; {:.1f} s, {:.1f} s of processors\n",
                      plural(counts.all(), "case"), plural(v.runs.size(), "run"), counts.passed, counts.failed,
                      counts.skipped, v.seconds, counts.processor_seconds);
  if (counts.repeated > 0)
    text += fmt::format("{} of {} equal bit for bit\n", counts.repeated - counts.unequal,
                        plural(counts.repeated, "repeated run"));
  if (v.long_left > 0) text += fmt::format("{} left out; --full takes them\n", plural(v.long_left, "long run"));
  if (counts.not_made > 0) text += fmt::format("interrupted: {} not made\n", plural(counts.not_made, "run"));
  return text;
}

}  // namespace fascia::app
