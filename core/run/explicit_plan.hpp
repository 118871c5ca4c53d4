#pragma once

#include <functional>

namespace fascia {

struct StepInfo;

/// Part of the stable step that steps are kept to: the material stiffens where it is stretched, and iterations find ω
/// from below.
inline constexpr double kStableMargin = 0.95;

struct ExplicitSettings {
  double time_step = 0;  ///< [s]; of automatic steps the largest safe one at the start
  int steps = 0;         ///< automatic: not used
  /// Which steps the observer sees, besides the last; asked after each step, of automatic ones again where they are
  /// taken again. Empty: all. Velocities at whole steps and the system's evaluation are made only for these.
  std::function<bool(const StepInfo&)> observed;
  double duration = 0;     ///< the last step is cut, so that it ends there [s]; 0: it is as long as the others
  bool automatic = false;  ///< steps follow the state, up to the duration
  double every = 0;        ///< automatic: a step ends at each multiple of it [s]; 0: anywhere
};

/// How long steps of central differences are and where they end.
///
/// Constant steps are as long as asked for, but for a last one that is cut. Automatic steps are as long as their limit
/// allows, in equal parts of the time to the next multiple of `every`. The limit is kStableMargin times the stable
/// step, which is found anew every few steps: it follows a shorter one at once and a longer one by bounded factors, and
/// is shortened by what the stable step is about to lose before it is looked for again. Where it lost more, the steps
/// since the last look are taken again.
class ExplicitPlan {
 public:
  ExplicitPlan(const ExplicitSettings& settings, double begin);

  double step() const { return dt_; }       ///< of the step that comes next [s]
  double end() const { return end_of(1); }  ///< of it [s]
  void take();                              ///< the step that comes next is taken; there is always another

  int taken() const { return taken_; }
  double time() const { return end_of(0); }
  bool done() const { return taken_ > 0 && (automatic_ ? segment_ == segments_ : taken_ >= steps_); }
  double progress() const;  ///< part of the whole [0, 1]

  /// The stable step at the present state is asked for: every few steps, where `every` has passed, and at the end.
  /// Besides, for what is seen.
  bool asks() const;
  /// The steps that were taken are too long for this one, which is that of the present state [s]. Also where it is no
  /// number.
  bool overruns(double stable) const { return !(longest_ <= kMostOfStable * stable); }
  /// Follows the stable step of the present state [s].
  void adopt(double stable);
  /// Back before steps that were too long. @param limit  of the steps that come next [s]
  void shorten(double limit);
  /// The stable step is next to nothing: the run will not end.
  bool collapsed() const { return automatic_ && limit_ < kCollapsed * first_limit_; }
  bool automatic() const { return automatic_; }
  double limit() const { return limit_; }  ///< what a step may take [s]

 private:
  static constexpr int kFirstLook = 10, kLeastLook = 10, kMostLook = 100, kFew = 20;
  static constexpr double kMostOfStable = 0.99, kMostLoss = 0.08, kMostForeseen = 0.2, kMostGrowth = 1.1, kIdle = 1.03,
                          kNoise = 2e-3, kCollapsed = 1e-6;

  double end_of(int ahead) const;
  double landing() const;
  void divide();
  void set_limit(double limit);

  double begin_, duration_, every_, first_limit_, limit_;
  int steps_, taken_ = 0;
  bool automatic_;
  double dt_ = 0;
  long segment_ = 0, segments_ = 1;  ///< of automatic steps: times between multiples of `every`
  double from_ = 0;                  ///< where the present equal steps begin [s]
  int equal_ = 1, done_ = 0;         ///< how many they are, and those taken
  int last_look_ = 0, next_look_ = kFirstLook;
  double stable_, longest_ = 0;  ///< at the last look, and of the steps since [s]
};

}  // namespace fascia
