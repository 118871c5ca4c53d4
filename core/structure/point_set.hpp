#pragma once

#include "core/base/aligned.hpp"
#include "core/math/mat3.hpp"
#include "core/physics/law_constants.hpp"
#include "core/physics/point_rule.hpp"
#include "core/physics/spring.hpp"
#include "core/structure/dependent_node.hpp"
#include "core/structure/dof_layout.hpp"
#include "core/structure/element_block.hpp"
#include "core/structure/shell_block.hpp"
#include "core/structure/stress_memory.hpp"
#include "core/structure/user_block.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace fascia {

/// Points of a group: they share their frames and are computed together.
inline constexpr int kGroupSize = 8;

/// Most frames that a group may have.
inline constexpr int kMaxSlots = 64;

/// How one frame moves a material point (docs/notation.md). With displacement u and D = Q − I of the frame,
///   displacement of the point = Σ w u + D b,   F − I = Σ u gᵀ + D B.
struct Influence {
  double w = 0;  ///< weight [-]
  Vec3d g{};     ///< ∇w [1/m]
  Vec3d b{};     ///< ψ, the frame's lever [m]
  Mat3d B{};     ///< ∇ψ [-]
};

/// An integration point as a builder describes it.
struct PointSample : LawConstants {
  Vec3d X{};                          ///< rest position [m]
  double volume = 0;                  ///< [m³]
  double stabilization = 0;           ///< γ [Pa]
  double stiffness_damping = 0;       ///< β [s]
  std::vector<Influence> influences;  ///< one for each node of its group
  Mat3d axes{};                       ///< of a thin law: tangents first; of a tether: its stiffness [N/m]
  int source = kNoSource;             ///< which point of its body it is, where it has a stress beside its law's

  static constexpr int kNoSource = -1;
  /// A point that stands for the volumetric part of all sources before it, back to the last such one.
  static constexpr int kVolumetric = -2;
};

/// Nodes that hang together though no point or element joins them, or a frame without any.
struct Joint {
  std::vector<int> nodes;
  double length = 0;  ///< converts torques to forces where residuals are judged and nothing else has a length [m]
};

/// Tells what of a set belongs to one body: runs of groups of points, of blocks of elements and of shells.
struct BodyBlocks {
  struct Run {
    int first = 0, count = 0;

    int end() const { return first + count; }
    template <class Act>
    void for_each(const Act& act) const {
      for (int k = first; k < end(); ++k) act(static_cast<std::size_t>(k));
    }
  };
  Run groups, elements, shells;
};

/// All integration points of a model: in groups of eight that share their frames (array of structures of arrays), and
/// in finite elements. Unused lanes repeat the group's last point with volume 0.
struct PointSet {
  DofLayout dofs;
  std::vector<int> slot_begin{0};  ///< (groups + 1): a slot is one frame of one group
  std::vector<int> slot_node;      ///< (slots)
  std::vector<int> lane_point;     ///< (groups × 8): running number of the point, −1 in unused lanes
  int point_count = 0;
  bool damped = false;  ///< any stiffness damping

  AlignedVector<double> shape;           ///< (slots × 13 × 8): w, g (3), B (9, by rows)
  std::vector<std::uint8_t> slot_lanes;  ///< (slots) bit of each lane whose point the frame moves; found by finish()
  AlignedVector<double> material;        ///< (groups × 6 × 8): volume, λ, μ, γ, β, gradient norm
  std::vector<GroupRule> rule;           ///< (groups)
  AlignedVector<double> axes;            ///< (groups that need them × 9 × 8): PointSample::axes by rows
  AlignedVector<double> own;             ///< (rows × 8): constants that a group's law has of its own
  /// (groups × 8) what each lane has beside its law's stress, and PointSample::source; empty where none has anything
  std::vector<StressBeside> beside;
  std::vector<int> source;
  MemoryLayout memory;  ///< of all blocks

  std::vector<int> node_slot_begin;  ///< (nodes + 1), transposed incidence
  std::vector<int> node_slot;        ///< slots of each node, ascending

  /// Part of each node: nodes of like stiffness that hang together. Residuals are judged by part, so that bone does not
  /// hide what is left in a strand on it (parts.hpp).
  std::vector<int> node_part;
  std::vector<double> part_length;  ///< (parts) mean spacing of its frames: makes torques and forces comparable [m]
  std::vector<int> part_whole;      ///< (parts) the connected whole that it belongs to, whatever the stiffness

  std::vector<int> color_begin{0};  ///< groups of one colour share no frame
  std::vector<int> color_group;

  std::vector<ElementBlock> blocks;  ///< finite elements
  std::vector<ShellBlock> shells;
  std::vector<std::shared_ptr<const UserBlock>> user_blocks;
  std::vector<Spring> springs;
  std::vector<double> group_length;  ///< (groups) spacing of the frames [m]
  std::vector<Joint> joints;
  std::vector<DependentNode> dependents;  ///< each behind those of its hosts that depend on others

  /// Calls act(nodes) for each group of points, element and shell of a body.
  template <class Act>
  void for_each_joined(const BodyBlocks& of, const Act& act) const {
    of.groups.for_each([&](std::size_t g) { act(nodes(static_cast<int>(g))); });
    of.elements.for_each([&](std::size_t b) { blocks[b].for_each_element(act); });
    of.shells.for_each([&](std::size_t b) {
      for (int e = 0; e < shells[b].count; ++e) act(shells[b].element(e));
    });
  }

  int node_count() const { return dofs.node_count(); }
  int group_count() const { return static_cast<int>(slot_begin.size()) - 1; }
  int part_count() const { return static_cast<int>(part_length.size()); }
  int part_of_group(int group) const { return node_part[static_cast<std::size_t>(nodes(group)[0])]; }
  int slot_count() const { return static_cast<int>(slot_node.size()); }
  std::span<const int> nodes(int group) const {
    const auto begin = static_cast<std::size_t>(slot_begin[static_cast<std::size_t>(group)]);
    const auto end = static_cast<std::size_t>(slot_begin[static_cast<std::size_t>(group) + 1]);
    return std::span(slot_node).subspan(begin, end - begin);
  }
  const double* shape_of_slot(int slot) const {
    return shape.data() + static_cast<std::size_t>(slot) * 13 * kGroupSize;
  }
  /// Constants that the group's law has of its own, by rows; the law must have some.
  const double* own_of_group(int group) const {
    return own.data() + static_cast<std::size_t>(rule[static_cast<std::size_t>(group)].own) * kGroupSize;
  }
  const double* material_of_group(int group) const {
    return material.data() + static_cast<std::size_t>(group) * 6 * kGroupSize;
  }
};

/// Rows of PointSet::material.
enum MaterialRow { kVolume, kLambda, kMu, kStabilization, kStiffnessDamping, kGradientNorm };

/// Collects groups and closes the set: order of dependent nodes, transposed incidence, connected parts and colours.
class PointSetBuilder {
 public:
  PointSetBuilder() = default;
  /// Opens a set again, to add to it.
  explicit PointSetBuilder(PointSet&& set);

  /// Adds points that share `nodes` and their rule; they are cut into groups of eight. Each point's F at rest must be
  /// I (Σ w = 1, Σ X gᵀ + B = I), which is checked by the caller's weights.
  /// @param length  spacing of the frames: converts torques to forces where residuals and rounding are judged [m]
  /// @throws InputError  a node that is named twice
  void add_points(std::span<const int> nodes, std::span<const PointSample> points, double length,
                  const PointRule& rule = {});

  /// Makes room for so many more groups, and frames of all of them together.
  void reserve(std::size_t groups, std::size_t slots);

  int group_count() const { return set_.group_count(); }

  void add_elements(ElementBlock block);

  void add_shell(ShellBlock shell);

  void add_user_block(std::shared_ptr<const UserBlock> block);

  int spring_count() const { return static_cast<int>(set_.springs.size()); }

  void add_spring(const Spring& spring);

  /// @pre no circle of nodes that depend on one another; a node depends at most once
  void add_dependent(DependentNode node);

  void join(std::vector<int> nodes, double length);

  /// Tells what was added since it was asked before: that of a body which was built meanwhile.
  BodyBlocks take_body();

  /// @throws InputError  where a user block names a node that there is not
  PointSet finish(std::vector<FrameKind> frames) &&;

 private:
  void add_in_order(std::span<const int> nodes, std::span<const PointSample> points, double length,
                    const PointRule& rule);
  void add_group(std::span<const int> nodes, std::span<const PointSample> points, double length, const PointRule& rule);
  void add_rule(std::span<const PointSample> points, double length, PointRule rule);
  void add_own_constants(std::span<const PointSample> points, GroupRule& group);
  void add_beside(std::span<const PointSample> points, const PointRule& rule);
  PointSet set_;
  BodyBlocks taken_;                  ///< the last that was taken
  std::vector<double> group_length_;  ///< spacing of the frames [m]
  std::vector<Joint> joints_;
};

}  // namespace fascia
