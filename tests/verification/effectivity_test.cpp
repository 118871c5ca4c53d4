// Estimated errors against true ones: their ratio, the effectivity, is between a half and two.
#include "tests/verification/effectivity_cases.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

namespace fascia::effectivity_test {
namespace {

using test::SceneRun;

/// The numbers of a value, in the order of the columns of probes.csv.
void append(const nlohmann::json& value, std::vector<double>& to) {
  if (!value.is_array()) return to.push_back(value.get<double>());
  for (const nlohmann::json& item : value) append(item, to);
}

/// Columns of a probe by saved time.
std::map<long, std::vector<double>> history(const SceneRun& run, const std::string& probe) {
  std::ifstream file(run.directory() / "probes.csv");
  std::string head;
  std::getline(file, head);
  std::vector<std::size_t> own;
  for (std::size_t begin = 0, column = 0; begin <= head.size(); ++column) {
    const std::size_t end = std::min(head.find(',', begin), head.size());
    const std::string name = head.substr(begin, end - begin);
    if (name.substr(0, name.find_first_of(".[")) == probe) own.push_back(column);
    begin = end + 1;
  }
  std::map<long, std::vector<double>> values;
  for (const std::vector<double>& row : run.history())
    for (const std::size_t c : own) values[std::lround(row[0] * 1e9)].push_back(row[c]);
  return values;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

struct Errors {
  double estimated = 0, real = 0;  ///< in the quantity's unit; of frequencies relative
};

/// The largest over the saved times, of the part that the time step makes.
Errors errors_over_time(const Case& c, const SceneRun& run, const nlohmann::json& estimate) {
  const SceneRun converged(c.scene, c.settings + c.converged + Settings{"output.estimate=false"}, {"--threads", "1"});
  const auto own = history(run, c.probe), fine = history(converged, c.probe);
  Errors e;
  for (const auto& [time, values] : own)
    if (const auto found = fine.find(time); found != fine.end())
      e.real = std::max(e.real, distance(values, found->second));
  e.estimated = estimate.at("time").get<double>() * estimate.at("scale").get<double>();
  return e;
}

Errors errors_of(const Case& c, const SceneRun& run) {
  const nlohmann::json& estimate = run.summary().at("estimated_error").at(c.probe);
  if (!c.converged.empty()) return errors_over_time(c, run, estimate);
  std::vector<double> values;
  append(run.probe(c.probe), values);
  Errors e;
  if (c.probe == "frequency") {
    for (std::size_t i = 0; i < values.size(); ++i) e.real = std::max(e.real, std::abs(values[i] / c.reference[i] - 1));
    e.estimated = estimate.at("total");
    return e;
  }
  const auto components = estimate.at("components").get<std::vector<double>>();
  std::vector<double> chosen, errors;
  for (const std::size_t i : c.components) {
    chosen.push_back(values.at(i));
    errors.push_back(components.at(i));
  }
  if (c.components.empty()) chosen = values, errors = components;
  e.real = distance(chosen, c.reference);
  e.estimated = distance(errors, std::vector<double>(errors.size()));
  return e;
}

/// Estimates the errors of the cases and prints them. @return  how many are within a factor of two
int measure(const std::vector<Case>& cases) {
  fmt::print("{:40} {:>12} {:>12} {:>12}  reference\n", "case", "estimated", "true", "effectivity");
  int within = 0;
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const SceneRun run(c.scene, c.settings, {"--threads", "1", "--estimate"});
    if (!run.ok() || !run.summary().contains("estimated_error")) {
      ADD_FAILURE() << "no estimate";
      continue;
    }
    const Errors e = errors_of(c, run);
    const double effectivity = e.estimated / e.real;
    fmt::print("{:40} {:12.4g} {:12.4g} {:12.2f}  {}\n", c.name, e.estimated, e.real, effectivity, c.source);
    const bool inside = effectivity >= 0.5 && effectivity <= 2;
    within += inside ? 1 : 0;
    EXPECT_TRUE(inside || !c.outside.empty()) << effectivity << " without a reason";
  }
  return within;
}

std::vector<Case> all() {
  std::vector<Case> cases = cantilevers();
  for (const auto& more : {others(), dynamics()}) cases.insert(cases.end(), more.begin(), more.end());
  return cases;
}

TEST(Effectivity, OfAFewCases) {
  std::vector<Case> quick;
  for (Case& c : all())
    if (c.quick) quick.push_back(c);
  EXPECT_EQ(measure(quick), static_cast<int>(quick.size()));
}

// 36 of 40 cases are to be within a factor of two.
TEST(Effectivity, OfAllCases) {
  const std::vector<Case> cases = all();
  EXPECT_GE(cases.size(), 40u);
  const int within = measure(cases), count = static_cast<int>(cases.size());
  fmt::print("{} of {} between 0.5 and 2\n", within, count);
  EXPECT_GE(10 * within, 9 * count);
}

}  // namespace
}  // namespace fascia::effectivity_test
