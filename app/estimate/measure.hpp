#pragma once

#include "app/estimate/plan.hpp"
#include "app/estimate/richardson.hpp"
#include "app/estimate/series.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace fascia::app {

/// Estimated errors of a quantity. They are relative to the largest value over time, as it is or as it would be without
/// the error of discretisation, whichever is larger; of frequencies each to itself.
struct EstimatedError {
  std::optional<double> discretisation, time, solver, precision;  ///< none: no estimate
  double order = 0;                                               ///< of the discretisation; 0: not known
  bool order_measured = false;
  bool by_finer = false;  ///< else by coarser twins alone, which is less certain
  double scale = 0;       ///< what they are relative to, in the quantity's unit; 1 of frequencies

  /// Of each component at the end, in the quantity's unit: the sum of what is known of it.
  std::vector<double> components;

  std::optional<double> total() const;  ///< their sum; none where one of them is missing
};

/// What is compared.
struct Measured {
  Series own;
  std::function<std::optional<Series>(TwinRole)> twin;  ///< the same of a twin; none where it failed or was not planned
  SeriesNorm norm = SeriesNorm::euclidean;
  double rounding = 0;        ///< differences below it are no error [unit of the quantity]
  OrderGuard order{};         ///< of the discretisation
  bool halved_finer = false;  ///< the finer twin takes half the step too, so that it is compared with that twin
  bool cut = false;           ///< a budget ended steps: twins, which have none, are compared with the exact one
};

/// Strains and stresses, which converge by an order less.
inline bool is_derivative(Quantity q) { return q == Quantity::strain || q == Quantity::stress; }

/// @param kind  of the solver: gives the order of its time steps
EstimatedError measured(const Measured& quantity, SolverKind kind, bool has_precision);

}  // namespace fascia::app
