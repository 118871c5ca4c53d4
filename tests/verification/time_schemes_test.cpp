// Time schemes through scenes: order, what each does exactly, damping, statics, moving supports, threads.
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace fascia::test::time_schemes_test {
namespace {

using Vector = std::array<double, 3>;

double norm(const Vector& v) { return std::hypot(v[0], v[1], v[2]); }
Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", v);
  return text;
}

Settings with(Settings settings, const Settings& more) {
  settings.insert(settings.end(), more.begin(), more.end());
  return settings;
}

constexpr const char* kImplicit[] = {"implicit-euler", "bdf2", "newmark", "midpoint"};
constexpr const char* kAll[] = {"implicit-euler", "bdf2", "newmark", "midpoint", "explicit"};
bool is_explicit(const std::string& kind) { return kind == "explicit"; }

/// [solver] of so many steps; implicit ones solved far below what is measured.
Settings steps_of(const std::string& kind, double h, int steps, const char* tolerance = "1e-11") {
  const std::string newton = is_explicit(kind) ? "" : std::string(",newton={tolerance=") + tolerance + "}";
  return {"solver={kind='" + kind + "',time_step=" + number(h) + ",steps=" + std::to_string(steps) + newton + "}"};
}

/// A run on one thread whose rows of probes.csv are found by the names in its header.
class TimedRun : public SolvedScene {
 public:
  TimedRun(const std::string& scene, const Settings& settings) : SolvedScene(scene, settings, 1) {}
  std::size_t size() const { return history().size(); }
  double at(std::size_t row, const std::string& name) const {
    const auto found = std::find(columns().begin(), columns().end(), name);
    EXPECT_NE(found, columns().end()) << name;
    return found == columns().end() ? NAN : history().at(row).at(static_cast<std::size_t>(found - columns().begin()));
  }
  Vector vector_at(std::size_t row, const std::string& name) const {
    return {at(row, name + ".x"), at(row, name + ".y"), at(row, name + ".z")};
  }
};

/// First order of implicit Euler, second of the others: differences of halved steps fall by 2 or 4. A body that tumbles
/// and swings within.
TEST(TimeSchemes, OrderInTime) {
  std::printf("%-12s %-15s %10s %12s %12s %7s\n", "elements", "kind", "step [s]", "difference", "halved", "ratio");
  for (const std::string model : {"tetrahedra", "hexahedra"}) {
    for (const std::string kind : kAll) {
      const double time = 0.06;
      const int steps = kind == "bdf2" ? 120 : 60;  // its error is larger, and the next order with it
      std::vector<Vector> ends[3];
      for (int k = 0; k < 3; ++k)
        ends[k] = TimedRun("midpoint_spin",
                           with(steps_of(kind, time / (steps << k), steps << k),
                                {"bodies.block.model='" + model + "'", "bodies.block.domain.box.cells=[3,1,1]",
                                 "bodies.block.material.young=2e4"}))
                      .vectors("points");
      double coarse = 0, fine = 0;
      for (std::size_t i = 0; i < ends[0].size(); ++i) {
        coarse += norm(minus(ends[0][i], ends[1][i]));
        fine += norm(minus(ends[1][i], ends[2][i]));
      }
      const double expected = kind == "implicit-euler" ? 2 : 4;
      std::printf("%-12s %-15s %10.4f %12.2e %12.2e %7.3f\n", model.c_str(), kind.c_str(), time / steps, coarse, fine,
                  coarse / fine);
      EXPECT_NEAR(coarse / fine, expected, 0.1 * expected) << kind;  // the next order is a few percent
    }
  }
}

/// From rest -g t^2 / 2, of implicit Euler -g h^2 n (n + 1) / 2, and no strain, with every kind of element.
TEST(TimeSchemes, FreeFallIsExact) {
  std::printf("%-22s %-15s %10s %11s %11s %10s\n", "elements", "kind", "step [s]", "error", "velocity", "strain");
  for (const std::string body : {"tetrahedra 1", "tetrahedra 2", "hexahedra 1", "hexahedra 2"}) {
    for (const std::string kind : kAll) {
      const int n = 20;
      const double h = is_explicit(kind) ? 3e-4 : 0.04;
      const TimedRun run(
          "midpoint_spin",
          with(steps_of(kind, h, n), {"bodies.block.model='" + body.substr(0, body.size() - 2) + "'",
                                      "bodies.block.order=" + body.substr(body.size() - 1),
                                      "bodies.block.domain.box.cells=[3,2,1]", "bodies.block.initial.velocity=[0,0,0]",
                                      "bodies.block.initial.angular_velocity=[0,0,0]", "world.gravity=[0,0,-9.81]"}));
      const double fall = -9.81 * h * h * n * (kind == "implicit-euler" ? n + 1 : n) / 2, speed = -9.81 * h * n;
      double error = 0, strain = 0;
      for (const Vector& u : run.vectors("points")) error = std::max(error, norm(minus(u, {0, 0, fall})) / -fall);
      for (const nlohmann::json& point : run.probe("strain"))
        for (const nlohmann::json& row : point)
          for (const nlohmann::json& e : row) strain = std::max(strain, std::abs(e.get<double>()));
      const double velocity = norm(minus(run.vector("velocity"), {0, 0, speed})) / -speed;
      std::printf("%-22s %-15s %10.4f %11.1e %11.1e %10.1e\n", body.c_str(), kind.c_str(), h, error, velocity, strain);
      EXPECT_LT(error, 1e-11) << body << kind;
      EXPECT_LT(velocity, 1e-11) << body << kind;
      EXPECT_LT(strain, 1e-11) << body << kind;
    }
  }
}

/// Free tumbling for a second (half a turn): momentum to rounding by all, angular momentum by midpoint and explicit.
TEST(TimeSchemes, TumblingBlockKeepsWhatItMust) {
  std::printf("%-15s %9s %10s %10s %12s %12s\n", "kind", "step [s]", "momentum", "spin", "energy", "last energy");
  for (const std::string kind : kAll) {
    const double h = is_explicit(kind) ? 1e-3 : 5e-3;
    const TimedRun run("midpoint_spin",
                       with(steps_of(kind, h, static_cast<int>(std::lround(1 / h))), {"output.every_steps=5"}));
    const Vector P = run.vector_at(0, "momentum"), L = run.vector_at(0, "angular_momentum");
    double momentum = 0, spin = 0, energy = 0;
    for (std::size_t i = 0; i < run.size(); ++i) {
      momentum = std::max(momentum, norm(minus(run.vector_at(i, "momentum"), P)) / norm(P));
      spin = std::max(spin, norm(minus(run.vector_at(i, "angular_momentum"), L)) / norm(L));
      energy = std::max(energy, std::abs(run.at(i, "total_energy") / run.at(0, "total_energy") - 1));
    }
    std::printf("%-15s %9.4f %10.1e %10.1e %12.1e %12.1e\n", kind.c_str(), h, momentum, spin, energy,
                run.at(run.size() - 1, "total_energy") / run.at(0, "total_energy") - 1);
    EXPECT_LT(momentum, 1e-9) << kind;
    EXPECT_NEAR(norm(P), 2 * std::sqrt(0.14), 1e-12);
    if (kind == "midpoint" || is_explicit(kind)) {
      EXPECT_LT(spin, 1e-9) << kind;
    } else if (kind != "implicit-euler") {
      EXPECT_LT(spin, 1e-3) << kind << ": second order";
    }
    if (kind == "implicit-euler") {
      EXPECT_GT(energy, 0.01) << "it damps";
    } else {
      EXPECT_LT(energy, 2e-3) << kind;  // (omega h)^2 / 12 of the motions that the spin excites
    }
  }
}

/// What each scheme makes of dv/dt = -alpha v in n steps of size h, from 1.
double damped_velocity(const std::string& kind, double alpha, double h, int n) {
  const double a = 0.5 * alpha * h;
  if (kind == "implicit-euler") return std::pow(1 / (1 + alpha * h), n);
  if (kind != "bdf2") return std::pow((1 - a) / (1 + a), n);
  double before = 1, v = (1 - a) / (1 + a);  // the first step is one of the midpoint rule
  for (int i = 1; i < n; ++i) {
    const double next = (v + (v - before) / 3) / (1 + alpha * 2 * h / 3);
    before = v;
    v = next;
  }
  return v;
}

TEST(TimeSchemes, MassDampingSlowsAFreeBody) {
  std::printf("%-15s %9s %16s %16s %16s\n", "kind", "step [s]", "momentum left", "of the scheme", "exp(-alpha t)");
  const double alpha = 3;
  for (const std::string kind : kAll) {
    const double h = is_explicit(kind) ? 1e-3 : 0.02;
    const int n = 25;
    const TimedRun run("midpoint_spin", with(steps_of(kind, h, n), {"bodies.block.initial.angular_velocity=[0,0,0]",
                                                                    "bodies.block.material.damping.mass=3"}));
    const double left = norm(run.vector("momentum")) / norm(run.vector_at(0, "momentum"));
    const double expected = damped_velocity(kind, alpha, h, n);
    std::printf("%-15s %9.4f %16.12f %16.12f %16.12f\n", kind.c_str(), h, left, expected, std::exp(-alpha * n * h));
    EXPECT_NEAR(left, expected, 1e-10) << kind;
    EXPECT_NEAR(left, std::exp(-alpha * n * h), kind == "implicit-euler" ? 0.02 : 1e-3) << kind;
  }
}

/// Stiffness damping follows the body: it stops what swings within, and neither gliding nor spinning.
TEST(TimeSchemes, StiffnessDampingLeavesRigidMotionAlone) {
  std::printf("%-15s %10s %10s   energy lost until 0.5 s, from 0.5 s to 1 s\n", "kind", "momentum", "spin");
  for (const std::string kind : {"midpoint", "explicit"}) {
    const double h = is_explicit(kind) ? 1e-4 : 5e-3;
    const TimedRun run("midpoint_spin",
                       with(steps_of(kind, h, static_cast<int>(std::lround(1 / h))),
                            {"bodies.block.material.damping.stiffness=5e-3",
                             "bodies.block.initial.angular_velocity=[0,0,3]", "output.every='0.5 s'"}));
    ASSERT_EQ(run.size(), 3U);
    const Vector P = run.vector_at(0, "momentum"), L = run.vector_at(0, "angular_momentum");
    const double momentum = norm(minus(run.vector("momentum"), P)) / norm(P);
    const double spin = norm(minus(run.vector("angular_momentum"), L)) / norm(L);
    const double start = run.at(0, "total_energy"), middle = run.at(1, "total_energy"), end = run.at(2, "total_energy");
    std::printf("%-15s %10.1e %10.1e %16.2e %16.2e\n", kind.c_str(), momentum, spin, 1 - middle / start,
                (middle - end) / start);
    EXPECT_LT(momentum, 1e-9) << kind;
    EXPECT_LT(spin, 1e-9) << kind;
    EXPECT_GT(1 - middle / start, 1e-7) << "the spin sets the block swinging, which dies away";
    EXPECT_LT(std::abs(middle - end), 1e-3 * (start - middle)) << kind;
  }
}

/// A cube of one element that moves along x only, under a small gravity: one degree of freedom,
/// u = u_s (1 - exp(-zeta omega t) (cos(omega_d t) + zeta / sqrt(1 - zeta^2) sin(omega_d t))).
TEST(TimeSchemes, DampedOscillatorAgainstTheClosedForm) {
  const double young = 2e6, poisson = 0.3, side = 0.2, density = 1000, g = 1e-4;
  const double modulus = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson));
  const double omega = std::sqrt(2 * modulus / density) / side;  // k = modulus side, half of the mass moves
  const double sag = 0.5 * density * g * side * side / modulus, duration = 3.25 * 2 * std::numbers::pi / omega;
  std::printf("%-15s %8s %8s %7s %12s %12s\n", "kind", "alpha/w", "beta w", "zeta", "error", "halved step");
  const std::pair<double, double> cases[] = {{0, 0}, {0.06, 0.04}};
  for (const auto& [alpha, beta] : cases) {
    const double zeta = 0.5 * (alpha + beta), root = std::sqrt(1 - zeta * zeta);
    const auto exact = [&](double t) {
      const double phase = root * omega * t;
      return sag * (1 - std::exp(-zeta * omega * t) * (std::cos(phase) + zeta / root * std::sin(phase)));
    };
    for (const std::string kind : kAll) {
      double error[2] = {};
      for (int k = 0; k < 2; ++k) {
        const int steps = 200 << k;
        const TimedRun run("explicit_cantilever",
                           with(steps_of(kind, duration / steps, steps, "1e-8"),
                                {"bodies.beam.domain.box={min=[0,0,0],max=[0.2,0.2,0.2],cells=[1,1,1]}",
                                 "world.gravity=[1e-4,0,0]", "output={every_steps=10}",
                                 "bodies.beam.material.damping={mass=" + number(alpha * omega) +
                                     ",stiffness=" + number(beta / omega) + "}",
                                 "constraints=[{body='beam',where={box={min=[-1,-1,-1],max=[0,1,1]}},fix='all'},"
                                 "{body='beam',where='all',fix=['y','z']}]",
                                 "probes.tip.at=[0.2,0.1,0.1]"}));
        ASSERT_EQ(run.size(), static_cast<std::size_t>(steps / 10 + 1));
        for (std::size_t i = 0; i < run.size(); ++i)
          error[k] = std::max(error[k], std::abs(run.at(i, "tip.x") - exact(run.at(i, "time"))) / sag);
      }
      std::printf("%-15s %8.2f %8.2f %7.3f %12.2e %12.2e\n", kind.c_str(), alpha, beta, zeta, error[0], error[1]);
      // With x = omega h = 0.1: phases lag by up to omega t x^2 / 3, implicit Euler damps by omega t x / 2.
      const double x = omega * duration / 200, most = kind == "implicit-euler" ? 0.5 * x : x * x / 3;
      EXPECT_LT(error[0], 1.1 * omega * duration * most) << kind;
      const bool first_order = kind == "implicit-euler" || (is_explicit(kind) && beta > 0);
      EXPECT_LT(error[1], (first_order ? 0.75 : 0.27) * error[0]) << kind;
    }
  }
}

/// Small swings of a cantilever about equilibrium die as exp(-zeta omega t), zeta = (alpha / omega + beta omega) / 2
/// with omega of kind = "modes" on the same mesh.
TEST(TimeSchemes, FirstModeDecaysAsRayleighDampingSays) {
  const Settings small{"bodies.beam.domain.box.cells=[6,1,1]", "world.gravity=[0,0,-1e-3]"};
  const SolvedScene modes("explicit_cantilever", with(small, {"solver={kind='modes',count=2}", "output={}",
                                                              "probes={first={quantity='frequency'}}"}));
  ASSERT_TRUE(modes.ok());
  const double omega = 2 * std::numbers::pi * modes.probe("first")[0].get<double>();
  const double sag =
      TimedRun("explicit_cantilever", with(small, {"solver={kind='static'}", "output={}"})).vector("tip")[2];
  std::printf("omega %.5f 1/s\n%-15s %8s %10s %12s %12s\n", omega, "kind", "alpha", "beta", "zeta", "measured");
  const double alpha = 0.05, beta = 0.01, zeta = 0.5 * (alpha + beta), damped = omega * std::sqrt(1 - zeta * zeta);
  for (const std::string kind : {"midpoint", "bdf2", "explicit"}) {
    const double h = is_explicit(kind) ? 5e-4 : 5e-3, duration = 8;
    const TimedRun run("explicit_cantilever",
                       with(small, with(steps_of(kind, h, static_cast<int>(std::lround(duration / h)), "1e-8"),
                                        {"output={every_steps=" + std::to_string(std::lround(0.04 / h)) + "}",
                                         "probes.speed={body='beam',at=[1,0,0],quantity='velocity'}",
                                         "bodies.beam.material.damping={mass=" + number(alpha * omega) +
                                             ",stiffness=" + number(beta / omega) + "}"})));
    // Least squares through the logarithms of the amplitudes, once the higher modes are gone.
    double n = 0, t1 = 0, t2 = 0, y1 = 0, ty = 0;
    for (std::size_t i = run.size() / 3; i < run.size(); ++i) {
      const double t = run.at(i, "time"), u = run.at(i, "tip.z") - sag;
      const double a = std::log(std::hypot(u, (run.at(i, "speed.z") + zeta * omega * u) / damped));
      n += 1;
      t1 += t;
      t2 += t * t;
      y1 += a;
      ty += t * a;
    }
    const double measured = -(n * ty - t1 * y1) / (n * t2 - t1 * t1) / omega;
    std::printf("%-15s %8.4f %10.6f %12.6f %12.6f\n", kind.c_str(), alpha * omega, beta / omega, zeta, measured);
    EXPECT_NEAR(measured, zeta, 0.01 * zeta) << kind;
  }
}

/// Damped dynamics ends at the static answer, whatever the step.
TEST(TimeSchemes, DampedRunEndsAtTheStaticAnswer) {
  const Settings body{"bodies.beam.domain.box.cells=[6,1,1]", "bodies.beam.material.damping={mass=20,stiffness=2e-3}"};
  for (const std::string model : {"tetrahedra", "hexahedra"}) {
    const Settings mesh = with(body, {"bodies.beam.model='" + model + "'"});
    const TimedRun still("explicit_cantilever", with(mesh, {"solver={kind='static'}", "output={}"}));
    const Vector reference = still.vector("tip");
    std::printf("%-12s %-15s %9s %12s %10s\n", model.c_str(), "kind", "step [s]", "u_z [m]", "error");
    for (const std::string kind : kAll) {
      for (const double h : {1.0, 0.25}) {
        const double step = h * (is_explicit(kind) ? 4e-4 : 0.04), duration = 2.8;
        const TimedRun run("explicit_cantilever",
                           with(mesh, with(steps_of(kind, step, static_cast<int>(std::lround(duration / step)), "1e-9"),
                                           {"output={every=1}"})));
        const double error = norm(minus(run.vector("tip"), reference)) / norm(reference);
        std::printf("%-12s %-15s %9.4f %12.8f %10.1e\n", "", kind.c_str(), step, run.vector("tip")[2], error);
        EXPECT_LT(error, 1e-6) << kind;  // exp(-10 s^-1 t) of the swing is left, and the solver's tolerance
      }
    }
  }
}

/// A support that shakes: it is where it must be at every step, and its force is the rate of the momentum and the
/// weight.
TEST(TimeSchemes, MovingSupports) {
  const double shift = 0.05, period = 0.4, omega = 2 * std::numbers::pi / period, weight = 40 * 9.81;
  const std::string support = "{box={min=[-0.001,-1,-1],max=[0.001,1,1]}}";
  std::printf("%-12s %-15s %12s %12s %16s\n", "body", "kind", "off target", "largest F", "F - dP/dt - W");
  for (const std::string model : {"tetrahedra", "hexahedra"}) {
    for (const std::string kind : kAll) {
      const double h = 1e-3;
      const TimedRun run(
          "explicit_cantilever",
          with(steps_of(kind, h, 100),
               {"bodies.beam.model='" + model + "'", "output={every_steps=1}", "bodies.beam.domain.box.cells=[5,1,1]",
                "bodies.beam.initial={velocity=[0,0," + number(shift * omega) + "]}",
                "constraints=[{body='beam',where=" + support +
                    ",move={translate=[0,0,0.05]},profile={sine={period=0.4}}}]",
                "probes.held={body='beam',at=[0,0.1,-0.1],quantity='displacement'}"}));
      double off = 0, largest = 0, unbalanced = 0;
      for (std::size_t i = 1; i + 1 < run.size(); ++i) {
        const double target = shift * std::sin(omega * run.at(i, "time"));
        off = std::max(off, norm(minus(run.vector_at(i, "held"), {0, 0, target})));
        const double F = run.at(i, "support_force.z");
        largest = std::max(largest, std::abs(F));
        // Implicit Euler balances with the backward difference; the others to second order with the central one.
        const bool backward = kind == "implicit-euler";
        const double rate =
            (run.at(backward ? i : i + 1, "momentum.z") - run.at(i - 1, "momentum.z")) / (backward ? h : 2 * h);
        if (i > 4) unbalanced = std::max(unbalanced, std::abs(F - rate - weight));
      }
      std::printf("%-12s %-15s %12.1e %12.3f %16.2e\n", model.c_str(), kind.c_str(), off, largest, unbalanced);
      EXPECT_LT(off, 1e-14) << kind;
      EXPECT_LT(unbalanced, (kind == "implicit-euler" ? 1e-8 : 0.02) * largest) << kind;
    }
  }
}

/// A bar is led along itself with a smooth profile: at its end the boundary slows it by 6 · 2 m / (2.5 s)², whatever
/// the mesh. A boundary that stood off by a dt²/8 would press the first cell, the harder the shorter it is.
TEST(TimeSchemes, LedBoundariesCarryTheMass) {
  const double force = -40 * 6 * 2 / (2.5 * 2.5);
  std::printf("%-15s %6s %12s %10s\n", "kind", "cells", "F [N]", "error");
  for (const std::string kind : kImplicit) {
    for (const int cells : {4, 32}) {
      const TimedRun run(
          "explicit_cantilever",
          with(steps_of(kind, 0.025, 100),
               {"bodies.beam.model='hexahedra'", "output={every_steps=1}", "world.gravity=[0,0,0]",
                "bodies.beam.domain.box.cells=[" + std::to_string(cells) + ",1,1]",
                "bodies.beam.material={young=1e6,poisson=0,damping={stiffness=0.005}}",
                "constraints=[{body='beam',where={box={min=[-0.001,-1,-1],max=[0.001,1,1]}},move={translate=[2,0,0]},"
                "over=2.5,profile='smooth'}]"}));
      const double F = run.at(run.size() - 1, "support_force.x"), error = F / force - 1;
      std::printf("%-15s %6d %12.5f %10.1e\n", kind.c_str(), cells, F, error);
      EXPECT_LT(std::abs(error), kind == "implicit-euler" ? 0.03 : 0.01) << kind << cells;
    }
  }
}

TEST(TimeSchemes, ThreadsDoNotMatter) {
  for (const std::string model : {"tetrahedra", "hexahedra"}) {
    for (const std::string kind : kAll) {
      const Settings settings =
          with(steps_of(kind, is_explicit(kind) ? 1e-4 : 1e-2, 3),
               {"bodies.beam.model='" + model + "'", "bodies.beam.domain.box.cells=[16,3,3]", "output={every_steps=1}",
                "bodies.beam.material.damping={mass=1,stiffness=1e-4}"});
      const SolvedScene one("explicit_cantilever", settings, 1);
      const SolvedScene two("explicit_cantilever", settings, 2);
      EXPECT_EQ(one.history(), two.history()) << model << kind;
      EXPECT_EQ(one.summary()["probes"], two.summary()["probes"]) << model << kind;
      EXPECT_EQ(two.summary().value("threads", 0), 2);
    }
  }
}

}  // namespace
}  // namespace fascia::test::time_schemes_test
