#include "io/gmsh/gmsh_sections.hpp"

#include <algorithm>
#include <cstddef>

namespace fascia::io {
namespace {

int checked_dimension(GmshInput& input) {
  const std::int64_t dimension = input.int32("the dimension of an entity");
  if (dimension < 0 || dimension > 3)
    input.fail("the dimension of an entity is " + std::to_string(dimension) + "; must be 0 to 3");
  return static_cast<int>(dimension);
}

/// The file says how many blocks and records follow in all; the blocks must add up to it.
struct Totals {
  std::size_t blocks = 0, records = 0, read = 0;

  Totals(GmshInput& input, std::size_t text_bytes, std::size_t binary_bytes, const char* what) {
    blocks = input.checked_count(input.size("the number of blocks"), 8, 20, "the number of blocks");
    records = input.checked_count(input.size(what), text_bytes, binary_bytes, what);
    input.size("the lowest number");
    input.size("the highest number");
  }

  std::size_t next_block(GmshInput& input, const char* what) {
    const std::int64_t count = input.size(what);
    if (count < 0 || static_cast<std::uint64_t>(count) > records - read)
      input.fail(std::string(what) + " of a block is " + std::to_string(count) + ", but only " +
                 std::to_string(records - read) + " are left of the section's; the file is damaged: write it again");
    read += static_cast<std::size_t>(count);
    return static_cast<std::size_t>(count);
  }

  void check_complete(GmshInput& input, const char* what) const {
    if (read != records)
      input.fail(std::string(what) + " of the blocks add up to " + std::to_string(read) + ", not to " +
                 std::to_string(records) + " as the section says; the file is damaged: write it again");
  }
};

std::vector<int> read_groups(GmshInput& input, GmshBuilder& builder, int dimension) {
  const char* what = "the number of physical groups";
  const std::size_t count = input.checked_count(input.size(what), 2, 4, what);
  constexpr std::size_t most_groups = 64;  // cells are repeated for each
  if (count > most_groups)
    input.fail("an entity has " + std::to_string(count) + " physical groups; must be at most 64");
  std::vector<int> groups;
  for (std::size_t g = 0; g < count; ++g) {
    const std::int64_t number = input.int32("a physical group");
    if (number == 0) continue;
    const int group = builder.group(dimension, number);
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
  }
  return groups;
}

}  // namespace

GmshEntities read_entities_41(GmshInput& input, GmshBuilder& builder) {
  std::array<std::size_t, 4> counts{};
  for (std::size_t& count : counts)
    count = input.checked_count(input.size("a number of entities"), 8, 36, "a number of entities");
  GmshEntities entities;
  for (int dimension = 0; dimension <= 3; ++dimension)
    for (std::size_t e = 0; e < counts[static_cast<std::size_t>(dimension)]; ++e) {
      const std::int64_t tag = input.int32("an entity's number");
      for (int c = 0; c < (dimension == 0 ? 3 : 6); ++c) input.number("a bound of an entity");
      std::vector<int> groups = read_groups(input, builder, dimension);
      if (!entities.try_emplace({dimension, tag}, std::move(groups)).second)
        input.fail("entity " + std::to_string(tag) + " of dimension " + std::to_string(dimension) + " appears twice");
      if (dimension == 0) continue;
      const char* what = "the number of bounding entities";
      const std::size_t bounding = input.checked_count(input.size(what), 2, 4, what);
      for (std::size_t b = 0; b < bounding; ++b) input.int32("a bounding entity");
    }
  return entities;
}

void read_nodes_41(GmshInput& input, GmshBuilder& builder) {
  Totals totals(input, 8, 32, "the number of nodes");
  builder.reserve_nodes(totals.records);
  std::vector<std::int64_t> tags;
  for (std::size_t b = 0; b < totals.blocks; ++b) {
    const int dimension = checked_dimension(input);
    input.int32("an entity's number");
    const bool parametric = input.int32("a parametric flag") != 0;
    tags.resize(totals.next_block(input, "the number of nodes"));
    for (std::int64_t& tag : tags) tag = input.size("a node number");
    for (const std::int64_t tag : tags) {
      Vec3d x;
      for (int c = 0; c < 3; ++c) x[c] = input.number("a coordinate");
      for (int c = 0; parametric && c < dimension; ++c) input.number("a parametric coordinate");
      builder.add_node(tag, x);
    }
  }
  totals.check_complete(input, "the nodes");
}

void read_elements_41(GmshInput& input, GmshBuilder& builder, const GmshEntities& entities) {
  Totals totals(input, 4, 16, "the number of elements");
  const std::vector<int> none{-1};
  std::vector<std::int64_t> nodes;
  for (std::size_t b = 0; b < totals.blocks; ++b) {
    const int dimension = checked_dimension(input);
    const std::int64_t entity = input.int32("an entity's number");
    const GmshElement element = gmsh_element(input.int32("an element type"), input);
    if (dimension_of(element.type) != dimension)
      input.fail("elements of dimension " + std::to_string(dimension_of(element.type)) + " in an entity of dimension " +
                 std::to_string(dimension) + "; the file is damaged: write it again");
    const auto known = entities.find({dimension, entity});
    if (known == entities.end() && !entities.empty())
      input.fail("entity " + std::to_string(entity) + " of dimension " + std::to_string(dimension) +
                 " is not in $Entities; write the file again");
    const bool grouped = known != entities.end() && !known->second.empty();
    const std::size_t count = totals.next_block(input, "the number of elements");
    nodes.resize(static_cast<std::size_t>(element.nodes));
    for (std::size_t e = 0; e < count; ++e) {
      const std::int64_t number = input.size("an element number");
      for (std::int64_t& node : nodes) node = input.size("a node number");
      for (const int group : grouped ? known->second : none) builder.add_cell(element, number, nodes, group);
    }
  }
  totals.check_complete(input, "the elements");
}

}  // namespace fascia::io
