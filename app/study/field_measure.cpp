#include "app/study/field_measure.hpp"

#include "app/compare/comparison.hpp"
#include "app/scene/diagnostics.hpp"
#include "core/base/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

FieldDistance trouble(std::string why) { return {0, 0, std::move(why)}; }

FieldDistance distance_of(const StudyMeasure& measure, const fs::path& directory, const fs::path& reference) try {
  const FieldComparison compared = compare_fields(directory, reference, {measure.field, measure.body, true});
  if (!compared.structure.empty())
    return trouble(fmt::format("with the run as A and the reference as B: {}", compared.structure.front()));
  if (compared.fields.empty())
    return trouble(fmt::format("run and reference share no {}field {}", measure.body.empty() ? "body with a " : "",
                               in_quotes(measure.field)));
  double apart = 0, own = 0, other = 0, volume = 0;
  for (const FieldDifference& d : compared.fields) {
    const auto body = std::find_if(compared.bodies.begin(), compared.bodies.end(),
                                   [&](const ComparedBody& b) { return b.name == d.body; });
    const double share = compared.fields.size() == 1 ? 1 : body->volume;
    apart += share * d.root_mean * d.root_mean;
    own += share * d.root_mean_a * d.root_mean_a;
    other += share * d.root_mean_b * d.root_mean_b;
    volume += share;
  }
  if (!(other > 0)) return trouble("the field of the reference is 0, of which no error is a part");
  return {std::sqrt(apart / other), std::sqrt(own / volume), ""};
} catch (const FileError& e) {
  return trouble(e.what());
} catch (const InputError& e) {
  return trouble(e.what());
}

}  // namespace

const FieldDistance& FieldDistances::at(const StudyMeasure& measure, const fs::path& directory,
                                        const fs::path& reference) {
  const std::array<std::string, 4> key{measure.field, measure.body, directory.string(), reference.string()};
  const auto found = known_.find(key);
  if (found != known_.end()) return found->second;
  return known_.emplace(key, distance_of(measure, directory, reference)).first->second;
}

}  // namespace fascia::app
