#include "app/verify/report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

namespace fascia::app {
namespace {

/// Rounding, whose digits another processor does not share.
bool is_rounding(const VerificationCase& c, const CaseOutcome& outcome) {
  constexpr double rounding = 1e-9;
  if (c.value == 0) return std::abs(outcome.error) < 0.1 * c.allowed.error;
  return std::abs(c.allowed.relative ? outcome.error : outcome.error / c.value) < rounding;
}

std::string computed_column(const VerificationCase& c, const CaseOutcome& outcome) {
  return with_unit(c.value == 0 && is_rounding(c, outcome) ? 0 : *outcome.value, c.unit);
}

std::string error_column(const VerificationCase& c, const CaseOutcome& outcome) {
  if (is_rounding(c, outcome)) return c.value == 0 ? "rounding" : "< 1e-7 %";
  return error_text(outcome.error, c.allowed, c.unit);
}

/// Text in a cell of a table.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

std::string row_of(const VerificationCase& c, const CaseOutcome* outcome) {
  const bool there = outcome && outcome->value;
  const std::string uncertain = c.uncertainty > 0 ? fmt::format(" ± {:.2g} %", 100 * c.uncertainty) : "";
  return fmt::format("| {} | {} | {}{} | {}{} | {} | {} | {} |\n", c.name, cell(c.title), with_unit(c.value, c.unit),
                     uncertain, cell(c.source), c.why.empty() ? "" : "; " + cell(c.why),
                     error_text(c.allowed.error, c.allowed, c.unit), there ? computed_column(c, *outcome) : "–",
                     there ? error_column(c, *outcome) : "–");
}

constexpr const char* kHead =
    "# Validation\n\n"
    "Every value that fascia is held to: its reference, where that comes from, what may differ and why, and what this "
    "version computes. One registry, `scenes/cases/*.toml`, serves this page, the tests and `fascia verify`, which "
    "makes "
    "these runs on your machine and writes a report with a certificate ([manual, "
    "Verification](manual/verification.md)). "
    "`fascia verify NAME` repeats a run of this page.\n\n"
    "This page is written by `fascia verify --full --write-validation docs/validation.md`.\n\n";

}  // namespace

std::string validation_page(const Registry& runs, const std::vector<RunOutcome>& outcomes) {
  std::string text = kHead;
  std::size_t cases = 0;
  std::map<std::string, std::size_t> features;
  for (const VerificationRun& run : runs) {
    cases += run.cases.size();
    for (const std::string& feature : run.features) features[feature] += run.cases.size();
  }
  text += fmt::format("{} cases in {} runs. By feature:", cases, runs.size());
  for (const auto& [feature, count] : features) text += fmt::format(" {} {},", feature, count);
  text.back() = '.';
  text += "\n";
  std::string topic;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const VerificationRun& run = runs[r];
    if (run.topic != topic) text += fmt::format("\n## {}\n", run.heading);
    topic = run.topic;
    text += fmt::format("\n**{}**, `{}`{}\n\n", run.title, run.name, run.full ? ", with `--full`" : "");
    text +=
        "| case | measured | reference | source; what limits the error | allowed | computed | error |\n"
        "|---|---|---|---|---|---|---|\n";
    for (std::size_t c = 0; c < run.cases.size(); ++c)
      text += row_of(run.cases[c], outcomes.empty() ? nullptr : &outcomes[r].cases[c]);
  }
  return text;
}

}  // namespace fascia::app
