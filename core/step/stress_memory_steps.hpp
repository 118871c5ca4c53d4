#pragma once

#include "core/space/array.hpp"
#include "core/step/memory_loops.hpp"

#include <limits>
#include <optional>
#include <vector>

namespace fascia {

/// How long stresses fade before the equations of a step hold: a time, as each kind of viscosity says of statics, or
/// not at all: at a state that was reached, where what is left acts, or at once from there, where growth acts in full.
struct Fading {
  enum class Of { time, statics, reached, at_once };
  Of of = Of::reached;
  double time = 0;  ///< [s]

  static Fading over(double time) { return time > 0 ? Fading{Of::time, time} : Fading{Of::statics, 0}; }

  BranchStep step_of(const Viscosity& kind, const ViscousBranch& branch) const {
    if (of == Of::reached) return {1, 0};
    if (of == Of::at_once) return {1, branch.share};
    if (of == Of::time) return BranchStep::of(branch, time);
    return BranchStep::of(branch, kind.instantaneous_statics ? 0 : std::numeric_limits<double>::infinity());
  }
  friend bool operator==(const Fading&, const Fading&) = default;
};

/// Says what the points of a set that remember stresses, or make them by themselves, add to the steps of a space, and
/// what they keep of them. Their memory is a part of a state (State::memory): a step that fails leaves it as it was.
template <class Space>
class StressMemory {
 public:
  explicit StressMemory(const MemoryLayout& layout, Space space = Space()) : layout_(layout), space_(space) {
    if (layout.empty()) return;
    lane_kind_.upload(layout.viscosity);
    given_.upload(neutral_rows());
    std::vector<double> relaxing = neutral_rows();
    for (std::size_t lane = 0; lane < layout.lanes(); ++lane) {
      const int kind = layout.viscosity[lane];
      if (kind >= 0 && layout.kinds[static_cast<std::size_t>(kind)]->shear_only)
        relaxing[MemoryLayout::place(lane, kGivenRows, kGivenFactors + 1)] = 0;
    }
    relaxing_.upload(relaxing);
    schedule_.upload(layout.schedule);
    active_.upload(layout.active);
  }

  bool empty() const { return layout_.empty(); }
  bool remembers() const { return layout_.remembers(); }
  bool acts() const { return layout_.acts(); }
  std::size_t size() const { return layout_.size(); }
  /// Numbers of give(), and of S_e.
  std::size_t given_size() const { return layout_.lanes() * kGivenRows; }
  std::size_t stress_size() const { return layout_.lanes() * 6; }

  /// Says how long stresses fade in the steps that follow. Loops that are recorded have it from here.
  void prepare(const Fading& fading) {
    if (empty() || fading == prepared_) return;
    const auto row_size = static_cast<std::size_t>(loops::MemoryView::row_size(layout_.branches));
    std::vector<double> steps(layout_.kinds.size() * row_size);
    for (std::size_t kind = 0; kind < layout_.kinds.size(); ++kind)
      fill_step(*layout_.kinds[kind], fading, steps.data() + kind * row_size);
    steps_.upload(steps);
    prepared_ = fading;
  }
  /// S₀ and factors of a step, (lanes × kGivenRows).
  /// @param memory   at its start
  /// @param factors  of all schedules, where it is looked at, in the space
  const double* give(double* memory, const double* factors) {
    const loops::ActiveView active{acts() ? schedule_.data() : nullptr, active_.data(), factors};
    space_.for_each(lanes(), loops::GiveStress{view(memory), active, given_.data()});
    return given_.data();
  }
  /// Rows with which laws give S_e, the stress that fades.
  const double* relaxing() const { return relaxing_.data(); }

  /// @param memory  at the start of a step; it becomes that at its end
  /// @param S       S_e at the end
  void keep(double* memory, const double* S) { space_.for_each(lanes(), loops::KeepStress{view(memory), S}); }

 private:
  int lanes() const { return static_cast<int>(layout_.lanes()); }

  std::vector<double> neutral_rows() const {
    std::vector<double> rows(given_size());
    for (std::size_t lane = 0; lane < layout_.lanes(); ++lane)
      for (int row = kGivenFactors; row < kGivenRows; ++row) rows[MemoryLayout::place(lane, kGivenRows, row)] = 1;
    return rows;
  }

  loops::MemoryView view(double* memory) const {
    return {lane_kind_.data(), steps_.data(), layout_.branches, stress_size(), memory};
  }

  static void fill_step(const Viscosity& kind, const Fading& fading, double* row) {
    const double lasting = kind.long_term();
    double factor = lasting;
    for (std::size_t k = 0; k < kind.branches.size(); ++k) {
      const BranchStep step = fading.step_of(kind, kind.branches[k]);
      row[4 + 2 * k] = step.decay;
      row[5 + 2 * k] = step.gain;
      factor += step.gain;
    }
    row[0] = factor;
    row[1] = kind.shear_only ? 1 : factor;
    row[2] = lasting;
    row[3] = kind.shear_only ? 1 : lasting;
  }

  const MemoryLayout& layout_;
  Space space_;
  std::optional<Fading> prepared_;
  Array<Space, int> lane_kind_, schedule_;
  Array<Space, double> steps_, given_, relaxing_, active_;
};

}  // namespace fascia
