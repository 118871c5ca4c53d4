#include "app/reader/table_reader.hpp"

#include <cmath>

namespace fascia::app {

Vec3d to_vector(const Value& list) {
  Vec3d v;
  for (int i = 0; i < 3; ++i) v[i] = std::get<double>((*list.as_array())[static_cast<std::size_t>(i)].data);
  return v;
}

TableReader::TableReader(const Value* table, std::string path, Diagnostics& diagnostics, Position otherwise)
    : table_(table),
      path_(std::move(path)),
      diagnostics_(&diagnostics),
      position_(table ? table->position : otherwise) {}

bool TableReader::has(std::string_view key) const { return given(key) != nullptr; }

const Value* TableReader::value(std::string_view key) const {
  const Value* found = given(key);
  return found && found->usable ? found : nullptr;
}

std::optional<double> TableReader::number(std::string_view key) const {
  const Value* found = value(key);
  return found ? std::optional(std::get<double>(found->data)) : std::nullopt;
}

std::optional<int> TableReader::integer(std::string_view key) const {
  const Value* found = value(key);
  return found ? std::optional(static_cast<int>(std::get<std::int64_t>(found->data))) : std::nullopt;
}

std::optional<std::string> TableReader::text(std::string_view key) const {
  const Value* found = value(key);
  return found ? std::optional(std::get<std::string>(found->data)) : std::nullopt;
}

std::optional<bool> TableReader::boolean(std::string_view key) const {
  const Value* found = value(key);
  return found ? std::optional(std::get<bool>(found->data)) : std::nullopt;
}

std::optional<Vec3d> TableReader::vector(std::string_view key) const {
  const Value* found = value(key);
  return found ? std::optional(to_vector(*found)) : std::nullopt;
}

std::optional<std::vector<Vec3d>> TableReader::vectors(std::string_view key) const {
  const Value* found = value(key);
  if (!found) return std::nullopt;
  std::vector<Vec3d> vectors;
  for (const Value& item : *found->as_array()) vectors.push_back(to_vector(item));
  return vectors;
}

std::optional<std::vector<int>> TableReader::integers(std::string_view key) const {
  const Value* found = value(key);
  if (!found) return std::nullopt;
  std::vector<int> numbers;
  for (const Value& item : *found->as_array()) numbers.push_back(static_cast<int>(std::get<std::int64_t>(item.data)));
  return numbers;
}

TableReader TableReader::table(std::string_view key) const {
  const Value* found = value(key);
  return {found && found->as_table() ? found : nullptr, path_of(key), *diagnostics_,
          found ? found->position : position_};
}

std::vector<TableReader> TableReader::tables(std::string_view key) const {
  std::vector<TableReader> readers;
  const Value* found = value(key);  // a list in the place of named tables was not looked into
  if (!found) return readers;
  if (const Array* items = found->as_array())
    for (std::size_t i = 0; i < items->size(); ++i)
      if ((*items)[i].as_table()) readers.push_back({&(*items)[i], join(path_of(key), i), *diagnostics_});
  if (const Table* members = found->as_table())
    for (const Member& member : *members) {
      if (!member.value.as_table()) continue;
      readers.push_back({&member.value, join(path_of(key), member.key), *diagnostics_});
      readers.back().name_ = member.key;
    }
  return readers;
}

std::optional<Vec3d> TableReader::direction(std::string_view key) const {
  const std::optional<Vec3d> v = vector(key);
  if (!v) return std::nullopt;
  const double length = norm(*v);
  if (length > 1e-150 && std::isfinite(length)) return v;
  error(key, "has no direction; must be a vector of a length other than 0");
  return std::nullopt;
}

Place TableReader::place(std::string_view key) const {
  const Value* found = given(key);
  return diagnostics_->place(found ? found->position : position_, path_of(key));
}

Place TableReader::place() const { return diagnostics_->place(position_, path_); }

void TableReader::refuse(const std::vector<std::string>& keys, const std::string& why) const {
  for (const std::string& key : keys)
    if (has(key)) error(key, why + "; remove it");
}

}  // namespace fascia::app
