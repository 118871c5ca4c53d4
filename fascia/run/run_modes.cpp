#include "fascia/run/run_modes.hpp"

#include "assembly/simulation/mechanisms.hpp"
#include "core/base/clock.hpp"
#include "core/base/index.hpp"
#include "core/math/rotation.hpp"
#include "core/run/modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

/// Stabilisation holds a hundredth of a body's own modes, and a tenth and more of those of badly coupled frames.
constexpr double kHollow = 0.1;
/// More than this part of a frequency is worth a word.
constexpr double kOpen = 1e-6;
/// Zeros are free motions where there are no more than that of them, and what rounding hides is so far below the body's
/// own frequencies.
constexpr double kFarBelow = 0.01;

void warn_of_modes(const Modes& modes, const Simulation& simulation, Warnings& warnings) {
  if (modes.uncertainty > kOpen)
    warnings.add("rounding",
                 fmt::format("rounding leaves {:.0e} of a frequency open: soft parts move beside stiff ones",
                             modes.uncertainty));
  const auto& f = modes.frequency;
  const auto own = std::find_if(f.begin(), f.end(), [](double value) { return value > 0; });
  const std::ptrdiff_t zeros = own - f.begin();
  const bool is_near = own != f.end() && modes.least > kFarBelow * *own;
  if (zeros > 0 && (is_near || zeros > free_motion_count(find_mechanisms(simulation))))
    warnings.add(
        "rounding",
        fmt::format("frequencies below {:.2g} Hz cannot be told from 0, for rounding of stiff parts", modes.least));
  const auto is_hollow = [](double part) { return part > kHollow; };
  const auto& parts = modes.stabilization;
  const auto first = std::find_if(parts.begin(), parts.end(), is_hollow);
  if (first != parts.end())
    warnings.add(
        "hollow",
        fmt::format("{} modes (the first: number {}) are motions of frames that the material hardly feels, held by "
                    "stabilisation: they are no modes of the body; use more rigid frames, on a grid",
                    std::count_if(parts.begin(), parts.end(), is_hollow), first - parts.begin() + 1));
}

/// A mode as a state: displacements up to a tenth of a size, frames turned in proportion; up to 0.1 rad where they turn
/// and nothing is displaced.
State shape_of(const Simulation& s, const std::vector<double>& shape, double size) {
  constexpr double kPart = 0.1, kNone = 1e-9;
  State state = State::at_rest(s.model);
  double largest = 0, turn = 0;
  const DofLayout& dofs = s.model.points.dofs;
  for (int i = 0; i < dofs.node_count(); ++i) {
    const double* d = shape.data() + dofs.begin(i);
    largest = std::max(largest, std::hypot(d[0], d[1], d[2]));
    if (dofs.kind(i) == FrameKind::rigid) turn = std::max(turn, std::hypot(d[3], d[4], d[5]));
  }
  const double scale = kPart * size / std::max({largest, largest <= kNone * size * turn ? size * turn : 0.0, 1e-300});
  for (int i = 0; i < dofs.node_count(); ++i) {
    const double* d = shape.data() + dofs.begin(i);
    state.u[at(i)] = Vec3d{{d[0], d[1], d[2]}} * scale;
    const bool rigid = dofs.kind(i) == FrameKind::rigid;
    state.D[at(i)] = rigid ? rotation_increment(Vec3d{{d[3], d[4], d[5]}} * scale)
                           : frame_variation(dofs.kind(i), d + 3, {}) * scale;
  }
  return state;
}

}  // namespace

RunEnd run_modes(const Simulation& s, ThreadPool& pool, RunListener& listener) {
  RunEnd end;
  end.warnings = Warnings(s.scene.silenced);
  end.state = s.initial;
  Clock::time_point start = Clock::now();
  const double processor = processor_seconds();
  const Modes modes = natural_modes(s.model, pool, s.scene.solver.modes);
  end.solve_seconds = seconds_since(start);
  end.processor_seconds = processor_seconds() - processor;
  end.frequencies = modes.frequency;
  end.report.steps = static_cast<int>(modes.frequency.size());
  end.report.linear_iterations = modes.iterations;
  if (!modes.converged) {
    end.report.status = RunStatus::not_converged;
    end.report.message = "the subspace iteration did not settle; ask for fewer modes";
  }
  end.failed = !modes.converged;
  warn_of_modes(modes, s, end.warnings);
  double size = 0;
  for (const SimulatedBody& b : s.bodies) size = std::max(size, b.body->size());
  start = Clock::now();
  for (std::size_t m = 0; m < modes.frequency.size(); ++m) {
    const State state = shape_of(s, modes.shape[m], size);
    const auto number = static_cast<double>(m + 1);
    const ProbedState probed{&state, nullptr, modes.frequency[m]};
    const ProbeValues values = probe_values(s, probed);
    listener.save(number, state);
    listener.show(number, probed, values);
    if (m + 1 == modes.frequency.size() || !listener.stops()) continue;
    end.report.status = RunStatus::interrupted;
    end.report.message = fmt::format("interrupted after {} modes of {}", m + 1, modes.frequency.size());
    end.failed = true;
    break;
  }
  end.output_seconds = seconds_since(start);
  return end;
}

}  // namespace fascia
