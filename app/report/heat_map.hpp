#pragma once

#include "app/report/result_state.hpp"

#include <string>
#include <vector>

namespace fascia::app {

struct HeatCell {
  ResultState state = ResultState::none;
  std::string sign;     ///< up to three characters; empty: the state's own
  std::string detail;   ///< why, with numbers; lines are kept
  std::string command;  ///< that repeats it; may be empty
  std::string anchor;   ///< of a heading in the same page; may be empty
};

/// A table of states. A cell shows its detail and command below the map once it is clicked; its colour says nothing
/// that its sign does not say.
struct HeatMap {
  std::string caption;
  std::string row_title, column_title;  ///< what rows and columns are, with units
  std::vector<std::string> rows, columns;
  std::vector<std::vector<HeatCell>> cells;  ///< (rows, columns)
};

/// The map as an HTML element, with a legend that counts the states.
/// @throws std::invalid_argument  cells are not (rows, columns)
std::string html_of(const HeatMap& map);

}  // namespace fascia::app
