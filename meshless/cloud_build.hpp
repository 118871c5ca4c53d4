#pragma once

#include "meshless/cloud_body.hpp"
#include "meshless/domain.hpp"
#include "meshless/matter.hpp"

#include <optional>
#include <string>
#include <variant>
#include <vector>

/// From a domain and what the user says of frames and points to a cloud body's description.
namespace fascia {

class SampleStore;

/// What a body fills, before its rigid placement X = rotation x + translation.
struct MatterParts {
  std::optional<SolidDomain> solid;
  std::vector<SheetPart> sheets;
  std::vector<LinePart> lines;
  Mat3d rotation = Mat3d::identity();
  Vec3d translation{};

  int dimension() const { return solid ? 3 : sheets.empty() ? 1 : 2; }  ///< the highest
};

struct SpacedChoice {
  double spacing = 0;  ///< mean [m]
  int seed = 1;
};
struct CountedChoice {
  int count = 0;
  int seed = 1;
};
/// Positions in the axes of the parts, scaled; rotations and volumes: none or as many.
struct ListedChoice {
  std::vector<Vec3d> position;
  std::vector<Vec3d> rotation;  ///< rotation vectors [rad]
  std::vector<double> volume;   ///< [m³]
};
using SampleChoice = std::variant<std::monostate, SpacedChoice, CountedChoice, ListedChoice>;

struct ScatterSpec {
  MatterParts parts;
  SampleChoice frames;
  SampleChoice points;  ///< none: 0.4 of the frames' spacing
  ScatteredKind weights = ScatteredKind::mls;
  std::optional<int> neighbours;
  std::optional<double> support;       ///< [m]
  std::vector<SharedFrame> shared{};   ///< of other bodies, in the placed body's axes; own frames stand around them
  int threads = 1;                     ///< that sample; 0: as many as there are processors
  const SampleStore* store = nullptr;  ///< of samples that were made before; null: none
};

/// Fills all of a spec that follows from the domain and the choice of frames, points and weights.
/// @throws InputError  coinciding frames, too few for the order, a sheet thicker than it is curved, ...
void scatter_cloud(const ScatterSpec& choice, CloudSpec& spec, std::vector<std::string>& messages);

struct ThinGridSpec {
  MatterParts parts;          ///< one flat sheet or one straight line
  ThinGrid grid;              ///< in the axes of the parts
  std::vector<int> per_cell;  ///< Gauss points of a cell along each direction; empty: 2, and 3 where there is one cell
  SampleChoice points;        ///< instead of per_cell
  std::function<double(const Vec3d&)> extent;  ///< thickness or radius by rest position [m]
  std::vector<SharedFrame> shared;             ///< of other bodies, placed: each where the grid has a frame
  int threads = 1;                             ///< as of ScatterSpec
  const SampleStore* store = nullptr;          ///< likewise
};

/// @throws InputError  a shared frame where the grid has none
void grid_cloud(const ThinGridSpec& choice, CloudSpec& spec);

}  // namespace fascia
