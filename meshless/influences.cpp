#include "meshless/influences.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "meshless/cloud_parts.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>

namespace fascia {

namespace {

/// Less than this of a point's motion comes from frames that turn: their mean says little of its rotation.
constexpr double kLeastTurning = 0.1;

bool contains(std::span<const int> ascending, int node) {
  return std::binary_search(ascending.begin(), ascending.end(), node);
}

}  // namespace

void make_distinct(std::vector<int>& nodes) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
}

void merge_nodes(Attachment& a) {
  std::vector<std::size_t> order(a.nodes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return a.nodes[i] < a.nodes[j]; });
  std::vector<int> nodes;
  std::vector<Influence> influences;
  for (const std::size_t k : order) {
    const Influence& i = a.influences[k];
    if (nodes.empty() || nodes.back() != a.nodes[k]) {
      nodes.push_back(a.nodes[k]);
      influences.push_back(i);
      continue;
    }
    Influence& sum = influences.back();
    sum = {sum.w + i.w, sum.g + i.g, sum.b + i.b, sum.B + i.B};
  }
  a.nodes = std::move(nodes);
  a.influences = std::move(influences);
}

std::vector<int> distinct_nodes(std::span<const SharedFrame> shared) {
  std::vector<int> nodes;
  for (const SharedFrame& s : shared) nodes.push_back(s.node);
  make_distinct(nodes);
  return nodes;
}

std::vector<int> still_nodes(std::span<const SharedFrame> shared) {
  std::vector<int> nodes;
  for (const SharedFrame& s : shared)
    if (!s.turns) nodes.push_back(s.node);
  make_distinct(nodes);
  return nodes;
}

bool blend_turning(std::span<const int> nodes, std::span<const int> still, std::vector<Influence>& influences) {
  double turning = 0;
  bool any_still = false;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const bool turns = !contains(still, nodes[k]);
    any_still = any_still || !turns;
    if (turns) turning += influences[k].w;
  }
  if (!any_still) return true;
  const bool enough = turning >= kLeastTurning;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    influences[k].w = enough && !contains(still, nodes[k]) ? influences[k].w / turning : 0.0;
  return enough;
}

void add_masses(std::span<const MassShare> shares, double damping, Model& model) {
  double all = 0, turning = 0;
  Vec3d missing;
  for (const MassShare& s : shares) {
    all += s.m;
    if (s.turns) turning += s.m;
    if (!s.turns) missing += s.d * s.m;
  }
  const Vec3d more = turning >= kLeastTurning * all ? missing * (1 / turning) : Vec3d{};
  for (const MassShare& s : shares) {
    const Vec3d d = s.d + more;
    const FrameInertia part = s.turns ? FrameInertia{s.m, d * s.m, outer(d, d) * s.m} : FrameInertia{s.m, {}, {}};
    model.inertia[at(s.node)] += part;
    if (damping > 0)
      model.mass_damping[at(s.node)] += {part.mass * damping, part.first * damping, part.second * damping};
  }
}

std::string replaced_by_shares(std::size_t count) {
  return std::to_string(count) + " frames coincide with shared ones and were replaced";
}

std::string unreached_shares(std::size_t count) {
  return std::to_string(count) +
         " shared nodes that reach no point of the body, or are denser than its points, were left out";
}

void refuse_off_grid(const Vec3d& x, double distance) {
  std::ostringstream out;
  out.precision(3);
  out << "the shared node at " << text(x) << " coincides with no frame of the grid (the nearest is " << distance
      << " m away); use scattered frames (poisson_disk)";
  throw InputError(out.str(), Blame::frames);
}

void refuse_second_share(const SharedFrame* known, const SharedFrame& share) {
  if (known == nullptr || known->node == share.node) return;
  throw InputError("two shared nodes coincide with one frame of the grid at " + text(share.x) +
                       "; share only one of them, or use scattered frames (poisson_disk)",
                   Blame::frames);
}

void check_held(const ModelBody& body, const Model& model, std::span<const int> still, std::span<const char> held) {
  const auto check = [&](int node) {
    if (held[at(node)] != 0 || contains(still, node)) return;
    throw InputError("nothing holds the rotation of the frame at " + text(model.rest_position[at(node)]) +
                         ": all points that follow it follow vertices without rotation too; share these with "
                         "rotations = true, or use more integration points and weights.drilling above 0",
                     Blame::frames);
  };
  for (int k = 0; k < body.node_count(); ++k) check(body.first_node() + k);
  for (const int node : body.shared_nodes()) check(node);
}

}  // namespace fascia
