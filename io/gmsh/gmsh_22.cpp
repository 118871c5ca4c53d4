#include "io/gmsh/gmsh_sections.hpp"

#include <cstddef>

namespace fascia::io {
namespace {

/// A count that stands as text, alone on its line, in binary files too.
std::size_t text_count(GmshInput& input, std::size_t text_bytes, std::size_t binary_bytes, const char* what) {
  const std::size_t count = input.checked_count(input.text_integer(what), text_bytes, binary_bytes, what);
  if (input.binary()) input.rest_of_line();
  return count;
}

/// Elements of one type with the same number of tags: one in ASCII files, many in binary ones.
struct ElementRun {
  std::size_t tags = 0;
  GmshElement element;
};

std::size_t checked_tags(GmshInput& input, std::int64_t tags) {
  return input.checked_count(tags, 2, 4, "the number of tags");
}

int physical_group(GmshBuilder& builder, const GmshElement& element, std::int64_t physical) {
  return physical == 0 ? -1 : builder.group(dimension_of(element.type), physical);
}

/// Tags and nodes of an element whose header is read.
void read_element(GmshInput& input, GmshBuilder& builder, const ElementRun& run, std::int64_t number,
                  std::vector<std::int64_t>& nodes) {
  std::int64_t physical = 0;
  for (std::size_t t = 0; t < run.tags; ++t) {
    const std::int64_t tag = input.int32("a tag");
    if (t == 0) physical = tag;
  }
  nodes.resize(static_cast<std::size_t>(run.element.nodes));
  for (std::int64_t& node : nodes) node = input.int32("a node number");
  builder.add_cell(run.element, number, nodes, physical_group(builder, run.element, physical));
}

void read_elements_text(GmshInput& input, GmshBuilder& builder, std::size_t count) {
  std::vector<std::int64_t> nodes;
  for (std::size_t e = 0; e < count; ++e) {
    ElementRun run;
    input.begin_line();
    const std::int64_t number = input.int32("an element number");
    run.element = gmsh_element(input.int32("an element type"), input);
    run.tags = checked_tags(input, input.int32("the number of tags"));
    read_element(input, builder, run, number, nodes);
    input.end_of_line("element " + std::to_string(number));
  }
}

void read_elements_binary(GmshInput& input, GmshBuilder& builder, std::size_t count) {
  std::vector<std::int64_t> nodes;
  for (std::size_t e = 0; e < count;) {
    ElementRun run;
    run.element = gmsh_element(input.int32("an element type"), input);
    const std::int64_t length = input.int32("the number of elements of a type");
    run.tags = checked_tags(input, input.int32("the number of tags"));
    if (length < 1 || static_cast<std::size_t>(length) > count - e)
      input.fail("a run of " + std::to_string(length) + " elements does not fit the " + std::to_string(count - e) +
                 " that are left; the file is damaged: write it again");
    for (std::int64_t k = 0; k < length; ++k, ++e) {
      const std::int64_t number = input.int32("an element number");
      read_element(input, builder, run, number, nodes);
    }
  }
}

}  // namespace

void read_elements_1(GmshInput& input, GmshBuilder& builder) {
  const std::size_t count = text_count(input, 12, 12, "the number of elements");
  std::vector<std::int64_t> nodes;
  for (std::size_t e = 0; e < count; ++e) {
    input.begin_line();
    const std::int64_t number = input.int32("an element number");
    const GmshElement element = gmsh_element(input.int32("an element type"), input);
    const std::int64_t physical = input.int32("a physical group");
    input.int32("an elementary entity");
    const std::int64_t said = input.int32("the number of nodes of an element");
    if (said != element.nodes)
      input.fail("element " + std::to_string(number) + " says that it has " + std::to_string(said) +
                 " nodes; its type has " + std::to_string(element.nodes) + ": correct the one or the other");
    nodes.resize(static_cast<std::size_t>(element.nodes));
    for (std::int64_t& node : nodes) node = input.int32("a node number");
    builder.add_cell(element, number, nodes, physical_group(builder, element, physical));
    input.end_of_line("element " + std::to_string(number));
  }
}

void read_nodes_22(GmshInput& input, GmshBuilder& builder) {
  const std::size_t count = text_count(input, 8, 28, "the number of nodes");
  builder.reserve_nodes(count);
  for (std::size_t n = 0; n < count; ++n) {
    input.begin_line();
    const std::int64_t tag = input.int32("a node number");
    Vec3d x;
    for (int c = 0; c < 3; ++c) x[c] = input.number("a coordinate");
    builder.add_node(tag, x);
    input.end_of_line("node " + std::to_string(tag));
  }
}

void read_elements_22(GmshInput& input, GmshBuilder& builder) {
  const std::size_t count = text_count(input, 8, 8, "the number of elements");
  if (input.binary())
    read_elements_binary(input, builder, count);
  else
    read_elements_text(input, builder, count);
}

}  // namespace fascia::io
