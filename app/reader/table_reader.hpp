#pragma once

#include "app/scene/diagnostics.hpp"
#include "assembly/specification/scene.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::app {

Vec3d to_vector(const Value& list);

/// Reads a table that was checked against the schema. Values that are missing or wrong (and reported) are not there.
class TableReader {
 public:
  /// @param table  null for a table that is missing
  /// @param otherwise  where a missing table would stand
  TableReader(const Value* table, std::string path, Diagnostics& diagnostics, Position otherwise = {});

  /// Whether the key was given, right or wrong.
  bool has(std::string_view key) const;
  /// The value of a key; null where it is missing or wrong.
  const Value* value(std::string_view key) const;

  std::optional<double> number(std::string_view key) const;
  std::optional<int> integer(std::string_view key) const;
  std::optional<std::string> text(std::string_view key) const;
  std::optional<bool> boolean(std::string_view key) const;
  std::optional<Vec3d> vector(std::string_view key) const;
  std::optional<std::vector<Vec3d>> vectors(std::string_view key) const;
  std::optional<std::vector<int>> integers(std::string_view key) const;
  TableReader table(std::string_view key) const;
  /// The tables of an array of tables, or of a table of tables.
  std::vector<TableReader> tables(std::string_view key) const;

  /// A direction: a vector that must not be zero.
  std::optional<Vec3d> direction(std::string_view key) const;

  /// Where the key's value stands; where it is missing, the table.
  Place place(std::string_view key) const;
  Place place() const;
  std::string path_of(std::string_view key) const { return join(path_, key); }

  void error(std::string_view key, std::string message) const { diagnostics_->add(place(key), std::move(message)); }
  void error(std::string message) const { diagnostics_->add(place(), std::move(message)); }
  /// Reports every one of `keys` that is there: "WHY; remove it".
  void refuse(const std::vector<std::string>& keys, const std::string& why) const;
  Diagnostics& diagnostics() const { return *diagnostics_; }

  bool exists() const { return table_ != nullptr; }
  /// False where something wrong with the table as a whole was reported.
  bool usable() const { return table_ && table_->usable; }
  const std::string& name() const { return name_; }  ///< last key of the path, for tables with names

 private:
  const Value* given(std::string_view key) const { return table_ ? table_->find(key) : nullptr; }

  const Value* table_;
  std::string path_, name_;
  Diagnostics* diagnostics_;
  Position position_;
};

}  // namespace fascia::app
