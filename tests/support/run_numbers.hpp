#pragma once

#include "tests/support/table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace fascia::test {

/// "key.path=value", as after --set.
using Settings = std::vector<std::string>;

/// The numbers that a run of a scene tells: its summary and its rows of probes.
class RunNumbers {
 public:
  /// It came to its end.
  bool ok() const { return ok_; }
  const nlohmann::json& summary() const { return summary_; }
  int newton_iterations() const { return summary_.value("newton_iterations", -1); }

  /// Value of a probe as JSON; null, with a failure, where there is none.
  nlohmann::json probe(const std::string& name) const {
    if (ok_ && summary_["probes"].contains(name)) return summary_["probes"][name]["value"];
    ADD_FAILURE() << "no probe " << name;
    return nullptr;
  }
  /// NaN where the probe is missing, so that every comparison fails.
  double number(const std::string& name) const { return as_number(probe(name)); }
  std::array<double, 3> vector(const std::string& name) const { return as_vector(probe(name)); }
  std::vector<std::array<double, 3>> vectors(const std::string& name) const {
    std::vector<std::array<double, 3>> all;
    for (const nlohmann::json& v : probe(name)) all.push_back(as_vector(v));
    return all;
  }
  /// Rows of probes.csv; the first column is the time.
  const std::vector<std::vector<double>>& history() const { return table_.rows; }
  /// Names of its columns.
  const std::vector<std::string>& columns() const { return table_.columns; }

  static double as_number(const nlohmann::json& v) {
    return v.is_number() ? v.get<double>() : std::numeric_limits<double>::quiet_NaN();
  }
  static std::array<double, 3> as_vector(const nlohmann::json& v) {
    if (!v.is_array() || v.size() != 3) return {as_number(nullptr), as_number(nullptr), as_number(nullptr)};
    return {as_number(v[0]), as_number(v[1]), as_number(v[2])};
  }

 protected:
  bool ok_ = false;
  nlohmann::json summary_ = nlohmann::json::object();
  Table table_;
};

/// "bodies.beam.frames.grid=[9,3,3]".
inline std::string grid_setting(const std::string& body, const std::array<int, 3>& grid) {
  return "bodies." + body + ".frames.grid=[" + std::to_string(grid[0]) + "," + std::to_string(grid[1]) + "," +
         std::to_string(grid[2]) + "]";
}

}  // namespace fascia::test
