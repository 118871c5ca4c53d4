#pragma once

#include "core/structure/model.hpp"

#include <vector>

namespace fascia {

/// A node that joins a model.
struct AddedNode {
  Vec3d X{};                              ///< rest position [m]
  Mat3d orientation = Mat3d::identity();  ///< at rest, of frames
  FrameKind kind = FrameKind::rigid;
  FrameInertia inertia{};
};

/// Points that join a model: they share nodes, old ones and added ones, and their rule.
struct AddedPoints {
  std::vector<int> nodes{};  ///< added ones have the numbers behind those of the model
  std::vector<PointSample> points{};
  double length = 1;  ///< spacing of the frames [m]
  PointRule rule{};
};

/// Elements of PointSet::blocks, or triangles of PointSet::shells.
struct LostCells {
  int block = 0;
  std::vector<int> cells{};
};

/// Inertia that a node loses, with the matter that carried it.
struct LostInertia {
  int node = 0;
  FrameInertia inertia;
};

/// A change of a model between two steps: matter is cut away or replaced, nodes join. Points whose influences change
/// are removed and added again. Nodes stay, whatever they lose.
struct Edit {
  std::vector<int> points{};  ///< that leave, by PointSet::lane_point
  std::vector<LostCells> elements{}, triangles{};
  std::vector<LostInertia> inertia{};
  std::vector<AddedNode> nodes{};
  std::vector<AddedPoints> added{};
};

/// Changes a model. What leaves keeps its place without volume and without gradients, so that nothing of it is
/// evaluated, however far its nodes part; numbers of nodes, groups and cells stay. All that was made of the model, such
/// as systems and steppers, is to be made again (ModelStepper::model_changed()).
///
/// @throws InputError  what leaves is not there, or left before; elements whose volumes are averaged about nodes; a
/// node
///                     that there is not; an inertia that would not stay positive; points for a model that remembers
///                     stresses. The model stays as it was, bit for
///                     bit
void apply(const Edit& edit, Model& model);

}  // namespace fascia
