#include "core/solver/verdict.hpp"

#include "core/base/index.hpp"

namespace fascia {

namespace {

double largest_root(std::initializer_list<double> squares) { return std::sqrt(std::max(squares)); }

/// The rounding floor as far as it excuses a residual: never more than a small share of the loads, of inertia and
/// momentum, or, where there is no load, of reactions that stand out of the rounding. Where nothing but rounding acts
/// (a body that was moved rigidly and rests) all of it.
double excused(const PartForces& f) {
  if (f.load > 0 || f.adrift)
    return std::min(f.rounding, kLargestShare * largest_root({f.load, f.inertia, f.momentum}));
  const double acting = largest_root({f.inertia, f.reaction, f.tether});
  return acting > kAboveRounding * f.rounding ? std::min(f.rounding, kLargestShare * acting) : f.rounding;
}

/// The size of what a whole has to balance.
double acting_on(const PartForces& whole) {
  const double loads = largest_root({whole.load, whole.inertia});
  return loads > 0 && !whole.driven ? loads : std::max(loads, largest_root({whole.reaction, whole.tether}));
}

/// A node of each group and element whose points make a stress by themselves, which shows in reactions as a motion
/// does.
std::vector<int> nodes_of_muscle(const PointSet& points) {
  const MemoryLayout& memory = points.memory;
  std::vector<int> nodes;
  if (!memory.acts()) return nodes;
  for (std::size_t lane = memory.begin[0]; lane < memory.begin[1]; ++lane)
    if (memory.schedule[lane] >= 0) nodes.push_back(points.nodes(static_cast<int>(lane / kGroupSize))[0]);
  for (std::size_t b = 0; b < points.blocks.size(); ++b) {
    const ElementBlock& block = points.blocks[b];
    std::size_t e = 0;
    block.for_each_element([&](std::span<const int> of_element) {
      const std::size_t lane =
          memory.begin[1 + b] + e / kElementLanes * at(block.points) * kElementLanes + e % kElementLanes;
      if (!block.beside.empty() && memory.schedule[lane] >= 0) nodes.push_back(of_element[0]);
      ++e;
    });
  }
  return nodes;
}

}  // namespace

std::vector<double> part_masses(const Model& model) {
  std::vector<double> squares(at(model.points.part_count()), 0.0);
  for (int node = 0; node < model.node_count(); ++node) {
    const double mass = model.inertia[at(node)].mass;
    squares[at(model.points.node_part[at(node)])] += mass * mass;
  }
  for (double& s : squares) s = std::sqrt(s);
  return squares;
}

std::vector<char> driven_parts(const Model& model) {
  const PointSet& points = model.points;
  std::vector<char> wholes(at(points.part_count()), 0), parts(wholes.size(), 0);
  const auto drive = [&](int part, int motion) {
    if (motion >= 0) wholes[at(points.part_whole[at(part)])] = 1;
  };
  for (const FrameConstraint& c : model.constraints) {
    for (const int motion : c.translation_motion) drive(points.node_part[at(c.node)], motion);
    for (const int motion : c.rotation_motion) drive(points.node_part[at(c.node)], motion);
  }
  for (const Tether& t : model.tethers) drive(points.part_of_group(t.group), t.motion);
  for (const int node : nodes_of_muscle(points)) drive(points.node_part[at(node)], 0);
  for (std::size_t p = 0; p < parts.size(); ++p) parts[p] = wholes[at(points.part_whole[p])];
  return parts;
}

void judge(std::span<const PartForces> parts, std::span<const int> whole, double tolerance, Evaluation& e) {
  std::vector<PartForces> wholes(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    PartForces& sum = wholes[at(whole[p])];
    sum.load += parts[p].load;
    sum.inertia += parts[p].inertia;
    sum.reaction += parts[p].reaction;
    sum.tether += parts[p].tether;
    sum.driven = sum.driven || parts[p].driven;
  }
  double total = 0;
  e.excess = e.relative = e.relative_floor = e.left_of_load = 0;
  e.by_rounding = false;
  e.within_rounding = false;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const PartForces& f = parts[p];
    const PartForces& all = wholes[at(whole[p])];
    total += f.residual;
    const double residual = std::sqrt(f.residual);
    const double reference = acting_on(all);
    double allowed = tolerance * reference;
    if (f.load > 0) allowed = std::min(allowed, kLargestShare * std::sqrt(f.load));
    allowed = std::max(allowed, tolerance * largest_root({f.load, f.inertia}));
    e.by_rounding = e.by_rounding || residual > allowed;
    allowed = std::max(allowed, excused(f));
    e.within_rounding = parts.size() == 1 && residual <= f.rounding && f.rounding <= kMostRounding * std::sqrt(f.load);
    const double excess = residual == 0 ? 0.0 : residual / std::max(allowed, 1e-300);
    const double own = f.load > 0 ? largest_root({f.load, f.inertia, f.momentum})
                                  : largest_root({f.inertia, f.momentum, f.reaction, f.tether});
    if (residual > 0) e.left_of_load = std::max(e.left_of_load, residual / std::max(own, 1e-300));
    if (excess < e.excess && p > 0) continue;
    e.excess = excess;
    const double scale = std::max({reference, f.rounding, 1e-300});
    e.relative = residual / scale;
    e.relative_floor = f.rounding / scale;
  }
  e.residual = std::sqrt(total);
}

}  // namespace fascia
