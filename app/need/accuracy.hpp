#pragma once

#include "app/need/trials.hpp"

#include <optional>
#include <vector>

namespace fascia::app {

/// What a quantity converges to as cells become small, by trials of several levels.
struct Convergence {
  Series limit;
  double uncertainty = 0;  ///< of the limit, relative to its largest value
  double order = 0;        ///< p of the error c h^p
  bool measured = false;   ///< by three levels; else it is assumed
  int levels = 0;
};

/// By Richardson's extrapolation of the finest levels. The error of the finest one is then at most 1.25 times what the
/// extrapolation adds where the order was measured (Roache's factor of safety for three levels), twice where it is
/// assumed; where differences do not fall the finest value stands, with 1.5 times the last difference.
/// @param h  sizes of cells, falling, with their values; two at least  @param assumed  order
std::optional<Convergence> convergence_of(const std::vector<double>& h, const std::vector<const Series*>& values,
                                          double assumed);

/// The errors of trials that differ in resolution alone, by what the surest of the families converges to. All families
/// are of the same bodies, so they converge to the same: where another one says otherwise, that is uncertainty too.
class Accuracy {
 public:
  /// @param like  the trials that count are those with its steps and scheme
  Accuracy(const Trials& trials, const NeedChoice& like);
  Accuracy(Accuracy&&) = default;
  Accuracy& operator=(Accuracy&&) = default;

  /// Relative error of a trial's quantity, with the uncertainty of what it is compared with; none where nothing is
  /// known of it.
  std::optional<double> error(const Trial& trial, std::size_t wanted) const;
  /// The largest of the errors over those allowed.
  std::optional<double> ratio(const Trial& trial) const;
  /// The same of a level that was not tried, by the nearest one that was and the order of the family.
  std::optional<double> predicted(const Resolution& r) const;
  /// The uncertainty of the limits over the allowed errors, the largest.
  double doubt() const;
  /// The same of what one family alone converges to.
  double doubt(int family) const;
  /// Limits rest on three levels, or on two families that agree within the allowed errors.
  bool confirmed() const;
  const std::optional<Convergence>& convergence(int family, std::size_t wanted) const {
    return of_[static_cast<std::size_t>(family)][wanted];
  }
  /// Good trials of a family, by level.
  const std::vector<const Trial*>& levels(int family) const { return levels_[static_cast<std::size_t>(family)]; }

 private:
  struct Best {
    const Convergence* convergence = nullptr;
    int family = 0;
    double uncertainty = 0;
    bool confirmed = false;
  };

  void compare(std::size_t wanted);

  const Trials* trials_;
  std::vector<std::vector<const Trial*>> levels_;            ///< by family
  std::vector<std::vector<std::optional<Convergence>>> of_;  ///< by family and quantity
  std::vector<Best> best_;                                   ///< by quantity
};

}  // namespace fascia::app
