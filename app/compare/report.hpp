#pragma once

#include "app/compare/comparison.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace fascia::app {

/// A comparison for people: the verdict, the largest difference with its place, and tables of at most twelve lines.
std::string words_of(const Comparison& comparison, double tolerance);

/// All of it.
nlohmann::ordered_json json_of(const Comparison& comparison, double tolerance);

}  // namespace fascia::app
