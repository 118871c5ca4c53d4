#pragma once

#include "core/base/index.hpp"
#include "core/space/node_rows.hpp"
#include "core/step/surface_loops.hpp"

#include <algorithm>
#include <cmath>

/// The bodies of Surfaces, for the files that instantiate it.
namespace fascia {

template <class Space>
Surfaces<Space>::Surfaces(const Model& model, Space space)
    : space_(space), loads_(model.surfaces), dofs_(at(model.dof_count())) {
  if (loads_.empty()) return;
  upload(model);
  const auto vertices = at(view_.vertices), surfaces = at(view_.surfaces);
  for (auto* array : {&u_, &x_, &area_, &weight_, &dx_, &pull_}) array->resize(vertices);
  for (auto* array : {&corner_area_, &corner_pull_}) array->resize(face_vertex_.size());
  corner_weight_.resize(weighs_ ? face_vertex_.size() : 0);
  weight_.set_zero();
  face_sums_.resize(3 * at(view_.faces));
  along_.resize(at(terms_));
  surface_sums_.resize(3 * surfaces);
  figures_.resize(surfaces * kSurfaceFigures);
  figures_.set_zero();
  for (auto* array : {&newton_, &aimed_, &saved_, &reached_}) {
    array->resize(surfaces);
    array->set_zero();
  }
  view_.u = u_.data();
  view_.x = x_.data();
  view_.corner_area = corner_area_.data();
  view_.corner_weight = corner_weight_.data();
  view_.face_sums = face_sums_.data();
  view_.area = area_.data();
  view_.weight = weight_.data();
  view_.surface_sums = surface_sums_.data();
  view_.figures = figures_.data();
}

/// Uploads what does not change.
template <class Space>
void Surfaces<Space>::upload(const Model& model) {
  std::vector<SurfaceRule> rules;
  std::vector<int> vertex_surface, face_surface, share_begin{0}, share_vertex, face_begin{0}, face_vertex, node;
  std::vector<int> term_surface, term_row, row_term, row_node;  // a row for each node of each term
  std::vector<Vec3d> X, datum;
  std::vector<SurfaceShare> shares;
  for (const SurfaceLoad& load : model.surfaces) {
    const int surface = static_cast<int>(rules.size()), first_vertex = static_cast<int>(X.size());
    rules.push_back({load.schedule, load.weight_schedule, load.has_potential, load.pressure, load.bulk_modulus,
                     load.rest_volume, load.volume, load.weight});
    conservative_ = conservative_ && load.has_potential;
    weighs_ = weighs_ || squared_norm(load.weight) > 0;
    part_.push_back(model.points.node_part[at(load.shares[0].node)]);
    datum.push_back(load.datum);
    std::vector<int> own;
    for (int v = 0; v < load.vertex_count(); ++v) {
      for (const SurfaceShare& share : load.shares_of(v)) {
        shares.push_back(share);
        share_vertex.push_back(first_vertex + v);
        own.push_back(share.node);
      }
      share_begin.push_back(static_cast<int>(shares.size()));
    }
    node.insert(node.end(), own.begin(), own.end());
    term_row.resize(shares.size(), -1);
    if (load.has_potential && load.bulk_modulus > 0) {
      const NodeRows rows(own, model.node_count());
      for (std::size_t k = 0; k < own.size(); ++k)
        term_row[shares.size() - own.size() + k] = static_cast<int>(row_node.size()) + rows.row[k];
      row_node.insert(row_node.end(), rows.nodes.begin(), rows.nodes.end());
      row_term.resize(row_node.size(), terms_++);
      term_surface.push_back(surface);
    }
    X.insert(X.end(), load.X.begin(), load.X.end());
    vertex_surface.resize(X.size(), surface);
    for (int f = 0; f < load.face_count(); ++f) {
      for (const int v : load.face(f)) face_vertex.push_back(first_vertex + v);
      face_begin.push_back(static_cast<int>(face_vertex.size()));
      face_surface.push_back(surface);
    }
  }
  std::vector<FaceRulePoint> points;
  constexpr int kCorners[] = {3, 4, 6, 8};
  for (int k = 0; k < 4; ++k) {
    const std::span<const FaceRulePoint> rule = face_rule(kCorners[k]);
    points.insert(points.end(), rule.begin(), rule.end());
    view_.points_begin[k + 1] = static_cast<int>(points.size());
  }
  const int surfaces = static_cast<int>(rules.size()), vertices = static_cast<int>(X.size());
  const NodeRows rows(node, model.node_count());
  by_vertex_ = RowSums<Space>(face_vertex, vertices, 6, space_);
  by_surface_ = RowSums<Space>(face_surface, surfaces, 0, space_);
  vertices_by_surface_ = RowSums<Space>(vertex_surface, surfaces, 0, space_);
  by_node_ = RowSums<Space>(rows.row, static_cast<int>(rows.nodes.size()), 12, space_);
  by_term_node_ = RowSums<Space>(term_row, static_cast<int>(row_node.size()), 0, space_);
  rule_.upload(rules);
  vertex_surface_.upload(vertex_surface);
  face_surface_.upload(face_surface);
  X_.upload(X);
  datum_.upload(datum);
  share_begin_.upload(share_begin);
  share_.upload(shares);
  share_vertex_.upload(share_vertex);
  face_begin_.upload(face_begin);
  face_vertex_.upload(face_vertex);
  points_.upload(points);
  loaded_.upload(rows.nodes);
  row_term_.upload(row_term);
  row_node_.upload(row_node);
  term_surface_.upload(term_surface);
  view_.vertices = vertices;
  view_.faces = static_cast<int>(face_surface.size());
  view_.surfaces = surfaces;
  view_.rule = rule_.data();
  view_.vertex_surface = vertex_surface_.data();
  view_.face_surface = face_surface_.data();
  view_.X = X_.data();
  view_.datum = datum_.data();
  view_.share_begin = share_begin_.data();
  view_.share = share_.data();
  view_.share_vertex = share_vertex_.data();
  view_.face_begin = face_begin_.data();
  view_.face_vertex = face_vertex_.data();
  view_.points = points_.data();
}

template <class Space>
void Surfaces<Space>::add_forces(const NodesView& nodes, const PoseView& pose, const double* factors, double* load) {
  space_.for_each(view_.vertices, loops::MoveVertex{view_, pose});
  space_.for_each(view_.faces, loops::FaceForces{view_, factors});
  if (weighs_)
    by_vertex_.template sum<6>(loops::CornerForces{view_}, loops::KeepVertexForces{view_});
  else
    by_vertex_.template sum<3>(loops::CornerVectors{corner_area_.data()}, loops::KeepVertexVectors{area_.data()});
  by_surface_.template sum<3>(loops::FaceSums{view_}, loops::KeepSurfaceSums{view_});
  vertices_by_surface_.template sum<1>(loops::SquaredArea{view_}, loops::FindPressure{view_, factors});
  by_node_.template sum<12>(loops::ShareForces{view_}, loops::AddNodeForces{loaded_.data(), nodes, pose, load});
}

template <class Space>
double Surfaces<Space>::potential(std::span<const double> figures) const {
  double energy = 0;
  for (std::size_t s = 0; s < part_.size(); ++s) energy += figures[s * kSurfaceFigures + kPotential];
  return energy;
}

template <class Space>
double Surfaces<Space>::rounding(int part, std::span<const double> figures) const {
  double squared = 0;
  for (std::size_t s = 0; s < part_.size(); ++s) {
    const double own = figures[s * kSurfaceFigures + kPressureRounding];
    if (part_[s] == part) squared += own * own;
  }
  return std::sqrt(squared);
}

template <class Space>
void Surfaces<Space>::linearize(const NodesView& nodes, const Mat3d* Q, const double* factors, Tangent tangent,
                                SurfaceTangent<Space>& out, double* node_blocks) {
  const auto surfaces = at(view_.surfaces), terms = at(terms_);
  out.curved = tangent == Tangent::full;
  out.stiffness.resize(terms);
  out.g.resize(terms * dofs_);
  out.g.set_zero();
  out.x.resize(at(view_.vertices));
  out.pressure.resize(surfaces);
  out.gradient.resize(surfaces);
  by_term_node_.template sum<12>(loops::ShareAreas{view_}, loops::KeepVolumeGradient{row_term_.data(), row_node_.data(),
                                                                                     nodes, Q, dofs_, out.g.data()});
  space_.for_each(terms_, loops::TakeStiffness{view_, term_surface_.data(), out.stiffness.data()});
  if (!out.curved) return;
  out.x.copy_from(x_);
  space_.for_each(view_.surfaces, loops::TakeTangent{view_, stepping_ ? newton_.data() : nullptr, factors,
                                                     out.pressure.data(), out.gradient.data()});
  by_node_.template sum<9>(loops::ShareMoments{view_, out.pressure.data()},
                           loops::AddNodeBlocks{loaded_.data(), nodes, Q, node_blocks});
}

template <class Space>
void Surfaces<Space>::add_product(const SurfaceTangent<Space>& tangent, const NodesView& nodes, const Mat3d* Q,
                                  const double* d, double* y, TangentPart part) {
  if (!tangent.curved) return;
  space_.for_each(view_.vertices, loops::MoveVertexAlong{view_, nodes, Q, d, dx_.data()});
  space_.for_each(view_.faces, loops::FaceProduct{view_, tangent.x.data(), tangent.pressure.data(),
                                                  tangent.gradient.data(), dx_.data(), corner_pull_.data(), part});
  by_vertex_.template sum<3>(loops::CornerVectors{corner_pull_.data()}, loops::KeepVertexVectors{pull_.data()});
  by_node_.template sum<12>(loops::ShareVectors{view_, pull_.data()},
                            loops::AddNodeProduct{loaded_.data(), nodes, Q, y});
}

template <class Space>
void Surfaces<Space>::change_volumes(const SurfaceTangent<Space>& tangent, const double* d) {
  constexpr int kTogether = 8;
  const int dofs = static_cast<int>(dofs_);
  const double *g = tangent.g.data(), *stiffness = tangent.stiffness.data();
  if (terms_ == 1) {
    space_.template sum<1>(dofs, loops::VolumeChange<1>{g, d, dofs_, 1},
                           loops::KeepAlong<1>{stiffness, along_.data(), 1});
    return;
  }
  for (int first = 0; first < terms_; first += kTogether) {
    const int count = std::min(kTogether, terms_ - first);
    space_.template sum<kTogether>(dofs, loops::VolumeChange<kTogether>{g + at(first) * dofs_, d, dofs_, count},
                                   loops::KeepAlong<kTogether>{stiffness + first, along_.data() + first, count});
  }
}

template <class Space>
void Surfaces<Space>::add_volume_product(const SurfaceTangent<Space>& tangent, const double* d, double* y) {
  if (terms_ == 0) return;
  change_volumes(tangent, d);
  space_.for_each(static_cast<int>(dofs_), loops::AddVolumes{tangent.g.data(), along_.data(), dofs_, terms_, y});
}

template <class Space>
void Surfaces<Space>::begin_step() {
  stepping_ = true;
  for (auto* array : {&newton_, &saved_, &aimed_}) array->copy_from(reached_);
}

template <class Space>
void Surfaces<Space>::aim(const SurfaceTangent<Space>& tangent, const double* direction) {
  if (terms_ == 0) return;
  change_volumes(tangent, direction);
  space_.for_each(terms_, loops::AimPressure{view_, term_surface_.data(), along_.data(), aimed_.data()});
}

template <class Space>
void Surfaces<Space>::approach(double step) {
  if (!stepping_) return;
  space_.for_each(view_.surfaces, loops::ApproachPressure{aimed_.data(), newton_.data(), step});
}

}  // namespace fascia
