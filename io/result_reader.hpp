#pragma once

#include "io/result_writer.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace fascia::io {

/// The numbers of a .vtu: "points", and each array of points and cells by its name.
using ResultArrays = std::map<std::string, std::vector<double>>;

/// Reads the numbers of a .vtu. @throws InputError  where it is none
ResultArrays read_result_arrays(const std::filesystem::path& vtu);

/// The points, cells and point fields of a .vtu that write_vtu made, and the part of each cell; not its cell fields,
/// time and provenance. Triangles come as VisualMesh::triangles, of shells too.
/// @throws InputError  where it is none, or damaged
VisualMesh read_vtu(const std::filesystem::path& vtu);

/// A line of a .pvd.
struct CollectionEntry {
  double time = 0;
  std::string body, file;  ///< its part; relative to the .pvd
};

/// The states that a .pvd of this program lists, in its order.
/// @throws FileError   where it cannot be read
/// @throws InputError  where it is no .pvd
std::vector<CollectionEntry> read_collection(const std::filesystem::path& pvd);

/// A table of numbers with a head, as probes.csv is one.
struct NumberTable {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;  ///< NaN where a cell is empty
};

/// Reads a table of numbers. @throws FileError, InputError
NumberTable read_number_table(const std::filesystem::path& csv);

}  // namespace fascia::io
