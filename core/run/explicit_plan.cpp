#include "core/run/explicit_plan.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

/// Parts of a time that are no longer than a limit; a rounding error adds none.
int parts_of(double time, double limit) {
  const double parts = std::ceil(time / limit * (1 - 1e-9));
  return std::max(1, static_cast<int>(std::min(parts, 2e9)));
}

}  // namespace

ExplicitPlan::ExplicitPlan(const ExplicitSettings& settings, double begin)
    : begin_(begin),
      duration_(settings.duration),
      every_(settings.every),
      first_limit_(settings.time_step),
      limit_(settings.time_step),
      steps_(settings.steps),
      automatic_(settings.automatic),
      dt_(settings.time_step),
      from_(begin),
      stable_(settings.time_step / kStableMargin) {
  if (automatic_) {
    if (!(every_ > 0 && every_ < duration_)) every_ = duration_;
    segments_ = std::max(1L, static_cast<long>(std::ceil(duration_ / every_ - 1e-9)));
  }
  divide();
}

/// The end of the present segment.
double ExplicitPlan::landing() const {
  if (segment_ >= segments_) return from_ + equal_ * dt_;
  if (segment_ + 1 == segments_) return begin_ + duration_;
  return begin_ + static_cast<double>(segment_ + 1) * every_;
}

/// The steps from the present time on.
void ExplicitPlan::divide() {
  if (automatic_) {
    const bool whole = from_ == begin_ + static_cast<double>(segment_) * every_ && segment_ + 1 < segments_;
    const double time = whole ? every_ : landing() - from_;
    equal_ = parts_of(time, limit_);
    dt_ = time / equal_;
    return;
  }
  dt_ = limit_;
  const double last = duration_ - (steps_ - 1) * limit_;
  if (duration_ > 0 && taken_ + 1 == steps_ && std::abs(last - limit_) > 1e-9 * limit_) dt_ = last;
}

double ExplicitPlan::end_of(int ahead) const {
  if (automatic_) return done_ + ahead == equal_ ? landing() : from_ + (done_ + ahead) * dt_;
  const int step = taken_ + ahead;
  if (duration_ <= 0 || step < steps_) return begin_ + step * limit_;
  return begin_ + duration_ + (step - steps_) * limit_;
}

void ExplicitPlan::take() {
  longest_ = std::max(longest_, dt_);
  ++taken_;
  ++done_;
  if (automatic_) {
    if (done_ < equal_) return;
    from_ = landing();
    ++segment_;
    done_ = 0;
    if (segment_ >= segments_) return;  // the next step would be as long as the last one
  }
  divide();
}

double ExplicitPlan::progress() const {
  if (done()) return 1;
  return automatic_ ? (time() - begin_) / duration_ : static_cast<double>(taken_) / steps_;
}

bool ExplicitPlan::asks() const {
  if (!automatic_) return false;
  const bool landed = done_ == 0 && taken_ - last_look_ >= kLeastLook;
  return taken_ >= next_look_ || landed || done();
}

void ExplicitPlan::adopt(double stable) {
  const int since = std::max(kLeastLook, taken_ - last_look_);
  const double lost = std::isfinite(stable_) ? std::log(stable_ / stable) : 0.0, loss = std::max(0.0, lost / since);
  const double until = kMostLoss / std::max(loss, kMostLoss / kMostLook);
  const int look = std::clamp(static_cast<int>(until), kLeastLook, std::max(2 * since, kLeastLook));
  last_look_ = taken_;
  next_look_ = taken_ + look;
  stable_ = stable;
  longest_ = 0;
  const double safe = kStableMargin * stable * std::exp(-std::min(loss * look, kMostForeseen));
  if (safe * (1 + kNoise) < limit_)
    set_limit(safe);
  else if (safe > kIdle * limit_)
    set_limit(std::min(safe, kMostGrowth * limit_));
}

void ExplicitPlan::shorten(double limit) {
  next_look_ = taken_ + kLeastLook;
  longest_ = 0;
  set_limit(std::min(limit, limit_));
}

/// A longer one counts from the next segment on where few steps of this one are left.
void ExplicitPlan::set_limit(double limit) {
  const bool later = limit > limit_ && equal_ - done_ < kFew;
  limit_ = limit;
  if (later || segment_ >= segments_) return;
  from_ = time();
  done_ = 0;
  divide();
}

}  // namespace fascia
