#pragma once

#include "tests/support/models.hpp"

#include <gtest/gtest.h>

namespace fascia::test {

struct Solved {
  State end;
  RunReport run;
};

/// The end of a load from rest, which must be an equilibrium.
inline Solved solved(const Model& model, const SolverSettings& settings) {
  ThreadPool pool(2);
  MechanicalSystem system(model, pool, settings);
  Solved out{State::at_rest(model), {}};
  out.run = run_statics(system, out.end, kRamp, settings, {}, nullptr);
  EXPECT_EQ(out.run.status, RunStatus::converged) << out.run.message;
  return out;
}

}  // namespace fascia::test
