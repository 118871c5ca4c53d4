#pragma once

#include "core/base/aligned.hpp"
#include "core/math/mat3.hpp"
#include "core/physics/law.hpp"
#include "core/physics/law_constants.hpp"
#include "core/structure/stress_memory.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace fascia {

/// Elements that are computed together, one a lane.
inline constexpr int kElementLanes = 8;

/// Constants of an element's material.
struct ElementMaterialSpec : LawConstants {
  double stiffness_damping = 0;  ///< β [s]
  double penalty = 0;            ///< κ of the volume penalty [Pa]
};

/// Elements of one kind as a builder describes them. Elements see the
/// displacements of their nodes alone.
struct ElementBlockSpec {
  Law law = Law::st_venant_kirchhoff;
  bool averaged = false;                      ///< the volumetric strain is averaged about nodes (one-point elements)
  int nodes = 4, points = 1;                  ///< of an element
  std::vector<int> node;                      ///< of the model (elements × nodes)
  std::vector<Vec3d> gradient;                ///< ∇N at rest (elements × points × nodes) [1/m]
  std::vector<double> volume;                 ///< (elements × points) [m³]
  std::vector<ElementMaterialSpec> material;  ///< (elements)
  std::vector<int> source{};                  ///< (elements): which one of its body it is
  /// (elements × points) what each point makes by itself, in the place of its element's; empty: as the elements do.
  std::vector<std::shared_ptr<const ActiveStress>> active{};
  double length = 1;  ///< mean length of the edges [m]
};

/// Elements of one kind in batches of eight (array of structures of arrays). Unused lanes repeat the last element with
/// volume 0 and without material; an element's nodes are in ascending order. Batches are bundled in patches of a few
/// hundred elements, whose nodes have numbers of their own: a patch sums its forces on them before the nodes gather the
/// sums of their patches.
struct ElementBlock {
  Law law = Law::st_venant_kirchhoff;
  bool averaged = false, penalised = false, damped = false;
  int nodes = 4, points = 1, count = 0;
  int own_constants = 0;  ///< of the law (core/physics/law_constants.hpp)
  double length = 1;

  AlignedVector<double> gradient;  ///< (batches × points × nodes × 3 × 8)
  AlignedVector<double> volume;    ///< (batches × points × 8)
  /// Rows of `material`; a law's own constants are the last ones.
  enum Row { kLambda, kMu, kStiffnessDamping, kPenalty, kOwnConstants };
  AlignedVector<double> material;  ///< (batches × material_rows() × 8)

  /// (batches × points × 8) what each point has beside its law's stress; empty where none has anything
  std::vector<StressBeside> beside;
  std::vector<int> source;  ///< as in ElementBlockSpec

  std::vector<int> patch_batch{0};               ///< (patches + 1)
  std::vector<int> patch_begin{0};               ///< (patches + 1): slots, each a node of a patch
  std::vector<int> patch_node;                   ///< (slots)
  std::vector<std::uint16_t> local;              ///< (batches × nodes × 8): the node's number in its patch
  std::vector<int> node_slot_begin, node_slot;   ///< slots of each node of the model, ascending
  std::vector<int> color_begin{0}, color_patch;  ///< patches of one colour share no node

  /// Its tangent takes extrapolated stresses (core/physics/point_physics.hpp): that of a law with large strain, where
  /// the stress is each point's own.
  bool extrapolates() const { return !averaged && is_of_points(law); }
  int batch_count() const { return (count + kElementLanes - 1) / kElementLanes; }
  int patch_count() const { return static_cast<int>(patch_batch.size()) - 1; }
  int slot_count() const { return static_cast<int>(patch_node.size()); }
  /// Nodes of the model that a patch has, in its own order.
  std::span<const int> nodes_of_patch(int patch) const {
    const auto begin = static_cast<std::size_t>(patch_begin[static_cast<std::size_t>(patch)]);
    const auto end = static_cast<std::size_t>(patch_begin[static_cast<std::size_t>(patch) + 1]);
    return std::span(patch_node).subspan(begin, end - begin);
  }
  const double* gradient_of(int batch, int point) const {
    return gradient.data() +
           (static_cast<std::size_t>(batch) * static_cast<std::size_t>(points) + static_cast<std::size_t>(point)) *
               static_cast<std::size_t>(nodes) * 3 * kElementLanes;
  }
  const double* volume_of(int batch, int point) const {
    return volume.data() +
           (static_cast<std::size_t>(batch) * static_cast<std::size_t>(points) + static_cast<std::size_t>(point)) *
               kElementLanes;
  }
  int material_rows() const { return kOwnConstants + own_constants; }
  const double* material_of(int batch) const {
    return material.data() +
           static_cast<std::size_t>(batch) * static_cast<std::size_t>(material_rows()) * kElementLanes;
  }
  LawConstants constants_of(int element) const;
  Lame lame_of(int element) const {
    const double* m = material_of(element / kElementLanes) + element % kElementLanes;
    return {m[kLambda * kElementLanes], m[kMu * kElementLanes]};
  }
  const std::uint16_t* local_of(int batch) const {
    return local.data() + static_cast<std::size_t>(batch) * static_cast<std::size_t>(nodes) * kElementLanes;
  }
  /// Calls act(nodes of the element, by number of the model, ascending) for each element, in their order.
  template <class Act>
  void for_each_element(const Act& act) const;
  /// Calls act(nodes, stiffness λ + 2μ [Pa]) for each element, as all blocks do (blocks.hpp).
  template <class Act>
  void for_each_cell(const Act& act) const {
    int element = 0;
    for_each_element([&](std::span<const int> nodes_of) { act(nodes_of, lame_of(element++).wave_modulus()); });
  }
  /// Σ v (λ + 2μ) |g|² over points and nodes: a measure of all that resists motion [N/m].
  double stiffness_sum() const;
};

/// Elements that lie near each other should follow each other.
ElementBlock make_element_block(const ElementBlockSpec& spec);

/// Closes a block once all nodes of the model are known: incidence and colours.
void finish_element_block(ElementBlock& block, int nodes_of_model);

template <class Act>
void ElementBlock::for_each_element(const Act& act) const {
  std::vector<int> element(static_cast<std::size_t>(nodes));
  for (int patch = 0; patch < patch_count(); ++patch) {
    const std::span<const int> patch_nodes = nodes_of_patch(patch);
    for (int batch = patch_batch[static_cast<std::size_t>(patch)];
         batch < patch_batch[static_cast<std::size_t>(patch) + 1]; ++batch) {
      for (int lane = 0; lane < kElementLanes && batch * kElementLanes + lane < count; ++lane) {
        for (int a = 0; a < nodes; ++a)
          element[static_cast<std::size_t>(a)] = patch_nodes[local_of(batch)[a * kElementLanes + lane]];
        act(std::span<const int>(element));
      }
    }
  }
}

}  // namespace fascia
