#pragma once

#include "core/body/model_body.hpp"
#include "meshless/shared_frame.hpp"

#include <span>

/// What frames of other bodies make of the influences on a point.
namespace fascia {

/// An influence of a frame as one of the node that carries it, `arm` away: with u_v = u + D r and D_v = D,
///   w' = w,   g' = g,   b' = b + w r,   B' = B + r gᵀ.
inline Influence on_node(const Influence& i, const Vec3d& arm) {
  return {i.w, i.g, i.b + arm * i.w, i.B + outer(arm, i.g)};
}

/// Sorts nodes and keeps each once.
void make_distinct(std::vector<int>& nodes);

/// Puts the nodes in ascending order; influences of equal ones, several frames of a rigid body, are added up.
void merge_nodes(Attachment& a);

/// Model nodes of shared frames, ascending, each once.
std::vector<int> distinct_nodes(std::span<const SharedFrame> shared);

/// Those of them that keep no rotation.
std::vector<int> still_nodes(std::span<const SharedFrame> shared);

/// Weights of the blended rotation at an integration point that still nodes move too: those of the nodes that turn,
/// over their sum W; 0 of the still ones. Without still nodes all stays.
/// @param still  ascending
/// @returns  whether the blend is worth a stabilisation: false where W is below 0.1
bool blend_turning(std::span<const int> nodes, std::span<const int> still, std::vector<Influence>& influences);

/// What a node takes of a point's mass.
struct MassShare {
  int node = 0;  ///< of the model
  double m = 0;  ///< [kg]
  Vec3d d{};     ///< from the node to the point [m]
  bool turns = true;
};

/// Adds the inertia of a point's mass to its nodes. Still ones take no lever; the others' grow by as much as keeps the
/// mass centre.
/// @param damping  α of the point's material [1/s]
void add_masses(std::span<const MassShare> shares, double damping, Model& model);

/// Over the body's size: shared and own frames this near to each other are one.
inline constexpr double kCoincident = 1e-6;

/// What a body says of frames that others stand for.
std::string replaced_by_shares(std::size_t count);
std::string unreached_shares(std::size_t count);

/// The error of a shared node where a grid has no frame.
/// @param distance  of the nearest one [m]
[[noreturn]] void refuse_off_grid(const Vec3d& x, double distance);

/// Throws where another node replaces the same frame of a grid already. @param known  that one, or null
void refuse_second_share(const SharedFrame* known, const SharedFrame& share);

/// Throws where the rotation of a node of the body is held by no point: all that follow it follow still nodes too, and
/// none of these has a stabilisation.
/// @param held  by model nodes: a point holds it
void check_held(const ModelBody& body, const Model& model, std::span<const int> still, std::span<const char> held);

}  // namespace fascia
