#include "core/base/errors.hpp"
#include "fem/from_mesh_parts.hpp"

namespace fascia::from_mesh_parts {
namespace {

using namespace element_parts;

CellType cell_type(ElementFamily family) {
  return family == ElementFamily::tetrahedra ? CellType::tetrahedron : CellType::hexahedron;
}

constexpr std::array<const char*, 8> plural{"points",     "lines",     "triangles", "quadrilaterals",
                                            "tetrahedra", "hexahedra", "wedges",    "pyramids"};

std::string name_of(CellType type) { return plural[static_cast<std::size_t>(type)]; }

/// How many cells of each type.
std::array<std::size_t, 8> count_types(const Mesh& mesh) {
  std::array<std::size_t, 8> counts{};
  for (const CellBlock& block : mesh.blocks) counts[static_cast<std::size_t>(block.type)] += block.size();
  return counts;
}

[[noreturn]] void fail_none(const Mesh& mesh, ElementFamily family, const std::array<std::size_t, 8>& counts) {
  const auto count = [&](CellType type) { return counts[static_cast<std::size_t>(type)]; };
  const std::string wanted = name_of(cell_type(family));
  const ElementFamily other =
      family == ElementFamily::tetrahedra ? ElementFamily::hexahedra : ElementFamily::tetrahedra;
  if (count(cell_type(other)) > 0)
    fail(mesh.file, "holds " + name_of(cell_type(other)) + ", no " + wanted + "; use model = \"" +
                        name_of(cell_type(other)) + "\"");
  for (const CellType type : {CellType::wedge, CellType::pyramid})
    if (count(type) > 0)
      fail(mesh.file, "holds " + name_of(type) + ", which make no elements here; mesh it with " + wanted);
  for (const CellType type : {CellType::triangle, CellType::quadrilateral, CellType::line, CellType::vertex})
    if (count(type) > 0) fail(mesh.file, "holds " + name_of(type) + " only; give a volume mesh of " + wanted);
  fail(mesh.file, "holds no cells; give a volume mesh of " + wanted);
}

/// A cell of the file and the element that it makes, with its corners sorted.
struct Entry {
  std::array<int, 8> key{};
  std::int64_t number = 0;
  int group = -1;
  int element = 0;
  const CellBlock* block = nullptr;
  std::size_t cell = 0;  ///< in the block
};

/// Cells with the same corners that make the same element: four corners make one linear tetrahedron only, in whatever
/// order they come.
bool same_element(const Entry& a, const Entry& b) {
  const auto same = [&](const std::vector<int>& of_a, const std::vector<int>& of_b, std::size_t count) {
    const auto begin = [&](const std::vector<int>& nodes, std::size_t cell) {
      return nodes.begin() + static_cast<std::ptrdiff_t>(cell * count);
    };
    return std::equal(begin(of_a, a.cell), begin(of_a, a.cell + 1), begin(of_b, b.cell));
  };
  const std::size_t middles = at(a.block->mid_nodes_per_cell);
  if (middles != at(b.block->mid_nodes_per_cell)) return false;
  if (a.block->type == CellType::tetrahedron && middles == 0) return true;
  return same(a.block->nodes, b.block->nodes, at(node_count(a.block->type))) &&
         same(a.block->mid_nodes, b.block->mid_nodes, middles);
}

/// For each cell, in the file's order, the first cell that it repeats (itself where it is the first).
/// A message says which repeat others by mistake, not for another group.
/// @throws InputError  a repetition of the corners that makes another element
std::vector<int> first_of_same(const std::string& file, std::vector<Entry> entries,
                               std::vector<std::string>& messages) {
  std::vector<int> first(entries.size());
  std::size_t copies = 0;
  std::string first_copy;
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.element < b.element; });
  for (std::size_t k = 0, end = 0; k < entries.size(); k = end) {
    for (end = k; end < entries.size() && entries[end].key == entries[k].key; ++end) {
      const Entry& entry = entries[end];
      for (std::size_t before = k; before < end; ++before) {
        const Entry& other = entries[before];
        if (other.number == entry.number || (other.group != entry.group && other.group >= 0 && entry.group >= 0))
          continue;
        if (!same_element(other, entry))
          fail(file, "elements " + std::to_string(other.number) + " and " + std::to_string(entry.number) +
                         " have the same nodes; remove one of them");
        if (copies++ == 0)
          first_copy = std::to_string(entry.number) + ", which repeats element " + std::to_string(other.number);
        break;
      }
      first[at(entry.element)] = entries[k].element;
    }
  }
  if (copies > 0)
    messages.push_back(file + ": left out " + std::to_string(copies) +
                       (copies == 1 ? " element that repeats another (element "
                                    : " elements that repeat others (the first: element ") +
                       first_copy + ")");
  return first;
}

}  // namespace

std::vector<const CellBlock*> family_blocks(const Mesh& mesh, ElementFamily family) {
  const std::array<std::size_t, 8> counts = count_types(mesh);
  const CellType wanted = cell_type(family);
  std::string others;
  for (const CellType type : {CellType::tetrahedron, CellType::hexahedron, CellType::wedge, CellType::pyramid}) {
    const std::size_t count = counts[static_cast<std::size_t>(type)];
    if (type != wanted && count > 0)
      others += (others.empty() ? "" : ", ") + std::to_string(count) + " " + name_of(type);
  }
  const std::size_t count = counts[static_cast<std::size_t>(wanted)];
  if (count == 0) fail_none(mesh, family, counts);
  if (!others.empty())
    fail(mesh.file, "mixes " + std::to_string(count) + " " + name_of(wanted) + " with " + others +
                        "; give volume cells of one type");
  std::vector<const CellBlock*> blocks;
  for (const CellBlock& block : mesh.blocks)
    if (block.type == wanted && block.size() > 0) blocks.push_back(&block);
  return blocks;
}

Cells distinct_cells(const Mesh& mesh, ElementFamily family, int order) {
  const std::vector<const CellBlock*> blocks = family_blocks(mesh, family);
  const std::size_t corners = at(corner_count(family));
  const auto has_middles = [](const CellBlock* block) { return block->mid_nodes_per_cell > 0; };
  const bool some = std::ranges::any_of(blocks, has_middles), all = std::ranges::all_of(blocks, has_middles);
  const std::string name = name_of(cell_type(family));
  if (order == 2 && some && !all)
    fail(mesh.file, "mixes linear and quadratic " + name + "; use order = 1 or mesh again");

  std::vector<Entry> entries;
  for (const CellBlock* block : blocks)
    for (std::size_t c = 0; c < block->size(); ++c) {
      Entry entry{{}, block->file_number[c], block->group[c], static_cast<int>(entries.size()), block, c};
      for (std::size_t n = 0; n < corners; ++n) entry.key[n] = block->nodes[c * corners + n];
      std::sort(entry.key.begin(), entry.key.begin() + static_cast<std::ptrdiff_t>(corners));
      entries.push_back(entry);
    }
  Cells result;
  result.mesh.messages = mesh.messages;
  const std::vector<int> first = first_of_same(mesh.file, std::move(entries), result.mesh.messages);
  result.elements_of_group.resize(mesh.groups.size());
  ElementMesh& made = result.mesh;
  made.shape = element_shape(family, all ? order : 1);
  made.file = mesh.file;
  made.nodes = mesh.points;
  made.node_number = mesh.point_file_number;
  if (some && order == 1)
    made.messages.push_back(mesh.file + ": its " + name + " are quadratic; only their corners are used (order = 2 " +
                            "uses the nodes between)");
  std::vector<int> element(first.size(), -1);
  std::size_t cell = 0;
  for (const CellBlock* block : blocks)
    for (std::size_t c = 0; c < block->size(); ++c, ++cell) {
      const bool repeats = first[cell] != static_cast<int>(cell);
      element[cell] = repeats ? element[at(first[cell])] : static_cast<int>(made.element_number.size());
      if (block->group[c] >= 0) result.elements_of_group[at(block->group[c])].push_back(element[cell]);
      if (repeats) continue;
      made.element_number.push_back(block->file_number[c]);
      const auto append = [&](const std::vector<int>& nodes, std::size_t count) {
        for (std::size_t n = 0; n < count; ++n) made.element_nodes.push_back(nodes[c * count + n]);
      };
      append(block->nodes, corners);
      if (order_of(made.shape) == 2) append(block->mid_nodes, at(block->mid_nodes_per_cell));
    }
  return result;
}

}  // namespace fascia::from_mesh_parts
