#include "app/compare/command.hpp"

#include "app/compare/report.hpp"
#include "app/run/run_scene.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace fascia::app {

int compare_command(const CompareOptions& options) {
  const Comparison comparison = compare(options.a, options.b, options.only);
  fmt::print("{}", options.json ? json_of(comparison, options.tolerance).dump(2) + "\n"
                                : words_of(comparison, options.tolerance));
  return comparison.within(options.tolerance) ? kDone : kDiffers;
}

}  // namespace fascia::app
