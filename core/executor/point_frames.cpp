#include "core/executor/point_frames.hpp"

#include "core/base/incidence.hpp"
#include "core/executor/point_kernels.hpp"

namespace fascia {

PointFrames::PointFrames(const PointSet& set, ThreadPool& pool)
    : set_(set), pool_(pool), lanes_(set), group_place_(at(set.group_count())) {
  for (std::size_t c = 0; c + 1 < set.color_begin.size(); ++c) {
    for (int i = set.color_begin[c]; i < set.color_begin[c + 1]; ++i)
      if (lanes_.count(set.color_group[at(i)]) == 0) shared_colors_.item.push_back(set.color_group[at(i)]);
    shared_colors_.begin.push_back(static_cast<int>(shared_colors_.item.size()));
  }
  int places = 0;
  for (int group = 0; group < set.group_count(); ++group) {
    if (lanes_.count(group) > 0) continue;
    shared_.push_back(group);
    group_place_[at(group)] = places;
    places += static_cast<int>(set.nodes(group).size());
    if (set.rule[at(group)].rule.law != Law::tether) continue;
    place_is_tether_.resize(at(group_place_[at(group)]), 0);
    place_is_tether_.resize(at(places), 1);
  }
  if (!place_is_tether_.empty()) place_is_tether_.resize(at(places + lanes_.node_total()), 0);
  for (int patch = 0; patch < lanes_.patch_count(); ++patch) {
    patch_place_.push_back(places + lanes_.first_node(patch));
    for (const int group : lanes_.groups(patch)) group_place_[at(group)] = patch_place_.back();
  }
  const auto for_each_place = [&](const auto& act) {
    int place = 0;
    for (const int group : shared_)
      for (const int node : set.nodes(group)) act(node, place++);
    for (int patch = 0; patch < lanes_.patch_count(); ++patch)
      for (const int node : lanes_.nodes(patch)) act(node, place++);
  };
  list_by_node(set.node_count(), for_each_place, node_place_begin_, node_place_);
  for (int node = 0; node < set.node_count(); ++node)
    if (node_place_begin_[at(node)] < node_place_begin_[at(node + 1)]) moving_.push_back(node);
  sums_.resize(at(places + lanes_.node_total()) * kNumbers);
}

PointFrames::Rows PointFrames::rows_of(const BlockState& state, AlignedVector<double>& room) const {
  room.resize(at(set_.node_count()) * kNumbers);
  pool_.for_ranges(static_cast<int>(moving_.size()), 256, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const int node = moving_[at(k)];
      double* row = room.data() + at(node) * kNumbers;
      const Mat3d& D = kernels::turn_of(state, node);
      for (int i = 0; i < 3; ++i) {
        row[i] = state.u[at(node)][i];
        for (int j = 0; j < 3; ++j) row[3 + 3 * i + j] = D(i, j);
      }
    }
  });
  return room.data();
}

void add_numbers(const double* s, NodeSum& sum) {
  for (int i = 0; i < 3; ++i) {
    sum.force[i] += s[i];
    for (int j = 0; j < 3; ++j) sum.N(i, j) += s[3 + 3 * i + j];
  }
}

void PointFrames::add_sums(int node, bool tethers, NodeSum& sum) const {
  for (int k = node_place_begin_[at(node)]; k < node_place_begin_[at(node + 1)]; ++k) {
    const int place = node_place_[at(k)];
    if (tethers && (place_is_tether_.empty() || place_is_tether_[at(place)] == 0)) continue;
    add_numbers(sums_.data() + at(place) * kNumbers, sum);
  }
}

}  // namespace fascia
