#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace fascia::test {

/// A table of numbers under a line of names, as probes.csv is.
struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

/// Reads a table of comma-separated numbers; it is empty where there is no such file.
inline Table read_table(const std::filesystem::path& path) {
  Table table;
  std::ifstream file(path);
  std::string line, cell;
  std::getline(file, line);
  for (std::istringstream head(line); std::getline(head, cell, ',');) table.columns.push_back(cell);
  while (std::getline(file, line)) {
    std::vector<double> row;
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace fascia::test
