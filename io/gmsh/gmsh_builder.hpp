#pragma once

#include "core/geometry/mesh.hpp"
#include "core/geometry/mid_nodes.hpp"
#include "io/gmsh/gmsh_input.hpp"

#include <map>
#include <span>
#include <unordered_map>
#include <utility>

namespace fascia::io {

/// A kind of cell of Gmsh.
struct GmshElement {
  CellType type = CellType::vertex;  ///< of its corners
  int nodes = 1;                     ///< all of them, corners first
  bool quadratic = false;  ///< the nodes behind the corners are mid-side nodes, then those of faces and centre
};

/// The kind with that number, or fails at the place of `input`.
GmshElement gmsh_element(std::int64_t number, const GmshInput& input);

/// Collects nodes, cells and groups of a Gmsh file into a Mesh. Both versions of the format feed it.
class GmshBuilder {
 public:
  GmshBuilder(GmshInput& input, MidNodes mid_nodes) : input_(input), mid_nodes_(mid_nodes) {}

  void reserve_nodes(std::size_t count);
  void add_node(std::int64_t tag, const Vec3d& x);

  /// The group of a dimension and number; a group of no name is called by its number.
  int group(int dimension, std::int64_t number);
  void name_group(int dimension, std::int64_t number, std::string name);

  /// @param node_tags  all of the cell's nodes, corners first
  /// @param group      index of a group, −1 for none
  void add_cell(const GmshElement& element, std::int64_t number, std::span<const std::int64_t> node_tags, int group);

  /// Everything collected, without the nodes that lie between corners and that no cell keeps.
  Mesh finish(const std::string& name);

 private:
  std::size_t index_of(std::int64_t tag, std::int64_t cell) const;
  CellBlock& block(CellType type, int mid_nodes_per_cell);

  GmshInput& input_;
  MidNodes mid_nodes_;
  Mesh mesh_;
  std::unordered_map<std::int64_t, int> index_;
  std::map<std::pair<int, std::int64_t>, int> groups_;
  std::vector<bool> kept_, between_;  ///< uses of each node: as a node of the mesh, as one that is dropped
};

}  // namespace fascia::io
