#pragma once

#include "app/extremes/judge.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace fascia::app {

struct MapSettings {
  int jobs = 1;                        ///< runs at once, each on one thread
  double time_limit = 60;              ///< of each run [s]
  double memory_limit = 4e9;           ///< of what it writes to [bytes]
  std::optional<std::string> backend;  ///< of the runs; the twins are the processor's
};

/// Cells and what came of them, in the same order.
struct ExtremesMap {
  std::string title;  ///< of what: "the map of extremes", "scenes/liver.toml"
  MapSettings settings;
  std::vector<ExtremeCell> cells;
  std::vector<CellOutcome> outcomes;     ///< of cells that have ended
  std::vector<char> ended;               ///< 1: its outcome stands; empty: all of them do
  std::vector<std::string> files;        ///< of their scenes, "cells/…toml"
  std::vector<std::string> regressions;  ///< sentences: cells that are worse than in a stored map
  std::vector<std::string> gains;        ///< sentences: cells that are better
  std::vector<std::string> others;       ///< what another program said of each cell; empty: nothing
  double seconds = 0;

  bool has_ended(std::size_t cell) const { return ended.empty() || ended[cell] != 0; }
};

/// Cells of each verdict.
std::vector<std::size_t> count(const ExtremesMap& map);

/// Runs every cell that has not ended, and a twin of each one that converges, in processes of their own.
/// @param directory  their scenes are written to cells/ of it
/// @param tell  is told of each cell that ended: how many of how many
/// @param stop  once it says true the rest is left out: `ended` says what there is
void run_map(ExtremesMap& map, const std::filesystem::path& directory,
             const std::function<void(std::size_t, std::size_t)>& tell, const std::function<bool()>& stop);

/// Takes the outcomes of an older map that was made with the same settings, for run_map() to go on with.
/// @param directory  that holds its extremes.json and extremes.csv
/// @throws InputError  there is none, or it has other settings
void resume(ExtremesMap& map, const std::filesystem::path& directory);

/// Leaves out cells that have not ended.
void keep_ended(ExtremesMap& map);

/// extremes.csv: a row for each cell that has ended.
std::string csv_of(const ExtremesMap& map);

/// Leaves out cells that took longer in a stored map, and those that it has not.
/// @throws InputError  as compare_with_stored()
void keep_quick(std::vector<ExtremeCell>& cells, const std::filesystem::path& stored, double seconds);

/// Compares with a stored extremes.csv: a cell that got worse is a regression.
/// @throws InputError  no such table, or one that is not as a map is written: its line, and what is wrong
void compare_with_stored(ExtremesMap& map, const std::filesystem::path& stored);

/// Reads what another program said of cells: rows of a cell's file without ".toml", this program's status, the other's
/// and the difference of both, below a head whose third cell is the other's name.
/// @throws InputError  it is no such table, or none of its rows is a cell of the map
void read_beside(ExtremesMap& map, const std::filesystem::path& table);

/// extremes.html @param scenes  the folder that holds cells/, as one names it in a shell
std::string html_of(const ExtremesMap& map, const std::filesystem::path& scenes);

/// Cells of each verdict, those that lead astray, and what changed, for a terminal.
std::string text_of(const ExtremesMap& map);

}  // namespace fascia::app
