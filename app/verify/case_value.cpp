#include "app/verify/case_value.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <stdexcept>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

/// Why a value cannot be taken out of a summary.
struct NoValue : std::runtime_error {
  using std::runtime_error::runtime_error;
};

double sum_of_squares(const Json& value) {
  if (value.is_number()) return value.get<double>() * value.get<double>();
  if (!value.is_array()) throw NoValue("holds what is no number");
  double sum = 0;
  for (const Json& item : value) sum += sum_of_squares(item);
  return sum;
}

double number_in(const Json& value, const Entry& at) {
  if (at.norm) return std::sqrt(sum_of_squares(value));
  const Json* part = &value;
  for (const std::size_t index : at.indices) {
    if (!part->is_array()) throw NoValue("is a number where `at` wants a list");
    if (index >= part->size()) throw NoValue(fmt::format("has {} entries; `at` wants number {}", part->size(), index));
    part = &(*part)[index];
  }
  if (part->is_array())
    throw NoValue(fmt::format("is a list of {}; `at` must say which number is meant", part->size()));
  if (!part->is_number()) throw NoValue("is no finite number");
  return part->get<double>();
}

double probe_number(const Json& summary, const std::string& probe, const Entry& at) {
  const Json* probes = summary.contains("probes") ? &summary["probes"] : nullptr;
  if (!probes || !probes->contains(probe) || !(*probes)[probe].contains("value"))
    throw NoValue(fmt::format("the result has no probe \"{}\"", probe));
  try {
    return number_in((*probes)[probe]["value"], at);
  } catch (const NoValue& e) {
    throw NoValue(fmt::format("probe \"{}\" {}", probe, e.what()));
  }
}

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed:
      return "passed";
    case Verdict::failed:
      return "failed";
    case Verdict::skipped:
      return "skipped";
  }
  return "";
}

CaseOutcome judge(const VerificationCase& c, const Json& summary) {
  CaseOutcome outcome;
  outcome.verdict = Verdict::failed;
  try {
    double value = probe_number(summary, c.probe, c.at);
    if (!c.minus.empty()) value -= probe_number(summary, c.minus, c.at);
    value /= c.over;
    if (!std::isfinite(value)) throw NoValue("the value is not finite");
    outcome.value = value;
    const double difference = value - c.value;
    outcome.error = c.allowed.relative ? difference / c.value : difference;
    if (std::abs(difference) <= c.allowed.error * (c.allowed.relative ? std::abs(c.value) : 1))
      outcome.verdict = Verdict::passed;
    else
      outcome.reason = "the error is above what is allowed";
  } catch (const NoValue& e) {
    outcome.reason = e.what();
  }
  return outcome;
}

}  // namespace fascia::app
