#pragma once

#include "assembly/specification/scene.hpp"

#include <optional>
#include <string>
#include <vector>

/// What a scene that states a need leaves open, and how each of its choices is written.
namespace fascia::app {

/// A kind of discretisation: what is chosen beside the number of cells.
struct Family {
  std::string name;                    ///< "quadratic hexahedra", "affine frames"
  std::vector<std::string> overrides;  ///< "key.path=value"
  int least = 1;                       ///< the coarsest resolution that is worth a try
  int stretch = 1;                     ///< times as many cells along the directions of a body that are not thin
  std::vector<int> settled{};          ///< directions whose cells stay as many as at that one
  double order = 2;                    ///< of the error of displacements over the size of cells, where none is measured
};

/// A body with something to choose.
struct OpenBody {
  std::string name;
  std::string key;               ///< of its numbers of cells or frames, or of how often its mesh is cut
  std::vector<int> pattern;      ///< cells along each direction at resolution 1; empty: they stay, or are of a file
  bool fixed = false;            ///< the scene says them: other numbers only tell how large errors are
  bool frames = false;           ///< the key takes frames: one more than cells
  bool cut = false;              ///< the mesh of a file: resolutions are powers of 2
  int dimension = 3;             ///< of what it fills
  std::vector<Family> families;  ///< one at least, from cheap to dear
};

/// A choice for all open bodies. Body b takes the family of this number, or its last one.
struct Resolution {
  int family = 0;
  int level = 1;  ///< times as many cells along each direction as the pattern

  auto operator<=>(const Resolution&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 sees a 0 in it
};

struct OpenScene {
  std::vector<OpenBody> bodies;

  int families() const;                    ///< 1 where there is no open body
  bool takes(const Resolution& r) const;   ///< levels of meshes that are cut are powers of 2
  bool offers(const Resolution& r) const;  ///< it may be chosen: where all cells are fixed, level 1 alone
  bool resizes() const;                    ///< some body has a resolution to choose
  int least(int family) const;             ///< the coarsest level worth a try
  double order(int family) const;
  int dimension() const;  ///< the largest
  std::vector<std::string> overrides(const Resolution& r) const;
  /// Directions in which a body is a single cell wide at resolution 1, unlike others.
  std::vector<int> thin_directions(std::size_t body) const;
  /// The numbers of a body with twice the cells along some directions, as "key=value".
  std::string doubled(const Resolution& r, std::size_t body, const std::vector<int>& directions) const;
  /// The numbers of a body as "key=value"; none where it has none to choose, or not at that level.
  std::optional<std::string> numbers(const Resolution& r, std::size_t body) const;
  Family& family(std::size_t body, int number);
  /// "beam: quadratic hexahedra, 8 x 1 x 1 cells"; of several bodies one behind the other.
  std::string text(const Resolution& r) const;
};

/// Bodies with something to choose; where all cells are fixed, with them those that errors come from too.
/// @throws SceneError, FileError, InputError  a mesh file that cannot be read
OpenScene open_parts(const Scene& scene);

/// Cells of about equal size that fill edges of these lengths, as few as there can be: one along the shortest edge, at
/// most `slender` times as long as wide along others, at most `most` along one.
std::vector<int> pattern_of(const std::vector<double>& lengths, double slender, int most);

}  // namespace fascia::app
