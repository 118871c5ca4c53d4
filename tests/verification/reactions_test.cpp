// Forces at supports and in couplings are what acts, damping included, in every scheme: against closed forms, and
// against one another at two steps.
#include "tests/support/coupled_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <map>

namespace fascia::test::reactions_test {
namespace {

constexpr const char* kImplicit[] = {"implicit-euler", "bdf2", "newmark", "midpoint"};
constexpr const char* kAll[] = {"implicit-euler", "bdf2", "newmark", "midpoint", "explicit"};

std::string solver(const std::string& kind, double dt, double duration) {
  const std::string step = dt > 0 ? fmt::format("{:.17g}", dt) : "\"auto\"";
  return fmt::format("[output]\nevery={}\n[solver]\nbackend=\"cpu\"\nkind=\"{}\"\ntime_step={}\nduration={}\n{}",
                     duration, kind, step, duration, kind == "explicit" ? "" : "newton={tolerance=1e-10}\n");
}

std::string pull(const std::string& body, double length, double distance, const std::string& how) {
  return fix(body, box({-0.1, -1, -1}, {1e-4, 2, 2})) +
         fix(body, box({length - 1e-4, -1, -1}, {length + 0.1, 2, 2}),
             fmt::format("move={{translate=[{},0,0]}}\n{}", distance, how));
}

std::string forces(const std::string& body, double length) {
  return probe_of("left", body, box({-0.1, -1, -1}, {1e-4, 2, 2}), "force") +
         probe_of("right", body, box({length - 1e-4, -1, -1}, {length + 0.1, 2, 2}), "force") +
         fmt::format("[probes.energy]\nbody=\"{}\"\nquantity=\"energy\"\n", body);
}

// A cube of 1 m in 2 x 2 x 2 hexahedra, pulled by 0.1 m/s from the start.
constexpr double kYoung = 1e4, kRate = 0.1, kTime = 0.5;

std::string pulled_cube(const std::string& kind, double dt, double density, const std::string& damping) {
  return fmt::format("[materials.soft]\nyoung={}\npoisson=0\ndamping={{{}}}\n", kYoung, damping) +
         solver(kind, dt, kTime) +
         box_body("cube", Kind::hexahedra, {0, 0, 0}, {1, 1, 1}, 2, "", fmt::format("density={}", density)) +
         pull("cube", 1, kRate, "over=\"1 s\"") + forces("cube", 1);
}

/// Tension of a bar of section 1 m² at a stretch: P = l E(S), of St Venant and Kirchhoff.
double tension(double stretch) { return kYoung * stretch * (stretch * stretch - 1) / 2; }
/// What a viscous stress β C adds.
double viscous(double beta, double stretch, double stretch_rate) {
  return beta * kYoung * stretch * stretch * stretch_rate;
}

/// With next to no mass the cube stretches evenly: l = 1 + 0.1 t, and the force is tension(l) + viscous(l, l').
/// Implicit Euler takes the rate of Green's strain of the mean stretch in the step. The damping starts at once, after
/// which Newmark and the midpoint rule waver: stiff motions lose a part of 4 / (β ω² dt) a step.
TEST(Reactions, OfStiffnessDampingAreThoseOfTheClosedForm) {
  constexpr double kBeta = 0.2, kStep = 0.01;
  const double l = 1 + kRate * kTime, exact = tension(l) + viscous(kBeta, l, kRate);
  const double of_euler = exact - kBeta * kYoung * l * kRate * kRate * kStep / 2;
  std::printf("%-16s %12s %12s %12s %14s\n", "kind", "right [N]", "left [N]", "closed form", "energy [J]");
  for (const std::string kind : kAll) {
    const TextRun run(pulled_cube(kind, kind == "explicit" ? 0 : kStep, 1, fmt::format("stiffness=\"{} s\"", kBeta)));
    const double right = run.vector("right")[0], left = run.vector("left")[0], energy = run.number("energy");
    const double expected = kind == "implicit-euler" ? of_euler : exact;
    std::printf("%-16s %12.4f %12.4f %12.4f %14.8f\n", kind.c_str(), right, left, expected, energy);
    const double allowed = kind == "newmark" || kind == "midpoint" ? 5e-3 : 1e-6;  // of the mass
    EXPECT_NEAR(right, expected, allowed * expected) << kind;
    EXPECT_NEAR(left, -expected, allowed * expected) << kind;
    EXPECT_NEAR(energy, kYoung * std::pow((l * l - 1) / 2, 2) / 2, 1e-4 * energy) << kind << ": elastic alone";
  }
}

/// Of mass damping: the plane in the middle moves by m x'' + α m x' = T(right half) − T(left half), and the supports
/// carry α times their quarter of the mass. The reference is that equation in steps of 1 µs.
TEST(Reactions, OfMassDampingAreThoseOfTheClosedForm) {
  constexpr double kAlpha = 50, kMass = 1000, kStep = 0.01, h = 1e-6;
  double x = 0, v = 0;
  const auto acceleration = [&](double t, double at, double speed) {
    return (tension(1 + 2 * (kRate * t - at)) - tension(1 + 2 * at)) / (kMass / 2) - kAlpha * speed;
  };
  for (int i = 0; i < std::lround(kTime / h); ++i) {  // second order
    const double t = i * h, a = acceleration(t, x, v);
    const double middle = acceleration(t + h / 2, x + v * h / 2, v + a * h / 2);
    x += h * (v + a * h / 2);
    v += h * middle;
  }
  const double right = tension(1 + 2 * (kRate * kTime - x)) + kAlpha * kMass / 4 * kRate, left = -tension(1 + 2 * x);
  std::printf("%-16s %12s %12s   (reference %.4f, %.4f)\n", "kind", "right [N]", "left [N]", right, left);
  for (const std::string kind : kAll) {
    const TextRun run(pulled_cube(kind, kStep, kMass, fmt::format("mass=\"{} Hz\"", kAlpha)));
    std::printf("%-16s %12.4f %12.4f\n", kind.c_str(), run.vector("right")[0], run.vector("left")[0]);
    const double allowed = kind == "implicit-euler" ? 2e-3 : 1e-4;  // of the step
    EXPECT_NEAR(run.vector("right")[0], right, allowed * right) << kind;
    EXPECT_NEAR(run.vector("left")[0], left, allowed * right) << kind;
  }
}

/// A bar of 1 x 0.5 x 0.5 m, or a strip.
std::string bar(const std::string& model) {
  const std::string head = "[bodies.bar]\nmaterial=\"soft\"\ndensity=100\n";
  const std::string domain = "domain={box={min=[0,0,0],max=[1,0.5,0.5]";
  if (model == "tetrahedra") return head + "model=\"tetrahedra\"\n" + domain + ",cells=[4,2,2]}}\n";
  if (model == "shell")
    return head +
           "model=\"shell\"\nthickness=0.1\n"
           "domain={rectangle={origin=[0,0,0],edge_u=[1,0,0],edge_v=[0,0.5,0],cells=[6,3]}}\n";
  const std::string frames = model == "scattered" ? "poisson_disk=0.3" : "grid=[5,3,3]";
  return head + fmt::format("model=\"meshless\"\n{}}}}}\nframes={{{}{}}}\n", domain, frames,
                            model == "affine" ? ",kind=\"affine\"" : "");
}

Vector pulled(const std::string& model, const std::string& kind, double dt, const std::string& damping,
              const std::string& profile) {
  return TextRun("[materials.soft]\nyoung=1e4\npoisson=0\n" + damping + solver(kind, dt, 0.5) + bar(model) +
                 pull("bar", 1, 0.1, "over=\"1 s\"\n" + profile) + forces("bar", 1))
      .vector("right");
}
Vector smoothly_pulled(const std::string& model, const std::string& kind, double dt, const std::string& damping) {
  return pulled(model, kind, dt, damping, "profile=\"smooth\"");
}

/// What a force does as the step is halved.
struct Halved {
  double coarse = 0, fine = 0;  ///< relative differences from the reference
};

/// The reference is BDF2 with a quarter of the step: its own error is a sixteenth of what is looked at.
/// @param force  of a run of a kind with a step
void expect_agreement(const std::string& name, double dt, double without,
                      const std::function<Vector(const std::string&, double)>& force, bool central_differences = true) {
  const Vector reference = force("bdf2", dt / 4);
  std::printf("%-24s %10.4f %10.4f", name.c_str(), length(reference), without);
  EXPECT_GT(std::abs(length(reference) - without), 0.05 * length(reference)) << "damping counts";
  for (const std::string kind : kImplicit) {
    const Halved h{relative(force(kind, dt), reference), relative(force(kind, dt / 2), reference)};
    std::printf("  %7.1e %7.1e", h.coarse, h.fine);
    const bool euler = kind == "implicit-euler";
    // Stiff tethers, which nothing damps, swing in the schemes that damp nothing.
    const bool swings = (kind == "newmark" || kind == "midpoint") && name.starts_with("scattered");
    EXPECT_LT(h.fine, swings ? 1e-2 : euler ? 2e-3 : 1e-3) << name << ' ' << kind;
    // Of first order where errors of both signs do not cancel, of second that of BDF2. Newmark and the midpoint rule
    // take the acceleration of a support's own mass half a step and more before the end.
    if (h.fine > 3e-4) {
      EXPECT_GT(h.coarse / h.fine, 1.6) << name << ' ' << kind << ": order";
    }
    if (kind == "bdf2" && h.fine > 5e-5) {
      EXPECT_GT(h.coarse / h.fine, 3.0) << name << ' ' << kind << ": order";
    }
  }
  if (!central_differences) return static_cast<void>(std::printf("\n"));
  const double central = relative(force("explicit", 0), reference);
  std::printf("  %7.1e\n", central);
  EXPECT_LT(central, 1e-3) << name << " explicit";
}

void print_head() {
  std::printf("%-24s %10s %10s", "", "force [N]", "undamped");
  for (const std::string kind : kImplicit) std::printf("  %15s", kind.c_str());
  std::printf("  %7s\n", "explicit");
}

class ReactionsOf : public testing::TestWithParam<const char*> {};

TEST_P(ReactionsOf, AllSchemesAgree) {
  const std::string model = GetParam();
  print_head();
  for (const std::string damping : {"stiffness=\"0.2 s\"", "mass=\"20 Hz\""}) {
    const auto run = [&](const std::string& kind, double dt, const std::string& damped) {
      return smoothly_pulled(model, kind, dt, damped);
    };
    expect_agreement(
        model + " " + damping.substr(0, damping.find('=')), 0.02, length(run("midpoint", 0.02, "")),
        [&](const std::string& kind, double dt) { return run(kind, dt, "damping={" + damping + "}\n"); },
        model != "scattered");
  }
}

INSTANTIATE_TEST_SUITE_P(Models, ReactionsOf, testing::Values("tetrahedra", "grid", "affine", "scattered", "shell"));

/// After a motion that starts at once the tethers swing against the frames' masses. Stiffness damping ends that where
/// steps are short enough to follow it.
TEST(Reactions, OfTethersUnderExplicitSteps) {
  const std::string damping = "damping={stiffness=0.2}\n";
  const Vector bdf2 = pulled("scattered", "bdf2", 0.002, damping, "");
  const Vector central = pulled("scattered", "explicit", 0, damping, "");
  std::printf("BDF2 %.4f N, explicit %.4f N\n", bdf2[0], central[0]);
  EXPECT_LT(relative(central, bdf2), 1e-3);
}

/// Hexahedra, tissue that shares their vertices, and a cap of tetrahedra whose vertices follow the tissue.
std::string chain(const std::string& damping, const std::string& run) {
  return "[materials.soft]\nyoung=1e4\npoisson=0\n" + damping + run +
         box_body("organ", Kind::hexahedra, {0, 0, 0}, {0.5, 0.5, 0.5}, 4, "", "density=100") +
         box_body("tissue", Kind::grid, {0.5, 0, 0}, {1, 0.5, 0.5}, 4,
                  "{body=\"organ\",where=" + box({0.499, -1, -1}, {0.501, 1, 1}) + "}", "density=100") +
         box_body("cap", Kind::tetrahedra, {1, 0, 0}, {1.5, 0.5, 0.5}, 4, "", "density=100") +
         coupling("seam", "embed", "cap", box({0.999, -1, -1}, {1.001, 1, 1}), "to=\"tissue\"") +
         fix("organ", box({-0.1, -1, -1}, {1e-4, 2, 2})) +
         fix("cap", box({1.4999, -1, -1}, {1.6, 2, 2}),
             "move={translate=[0.1,0.02,0]}\nover=\"1 s\"\nprofile=\"smooth\"") +
         probe_of("right", "cap", box({1.4999, -1, -1}, {1.6, 2, 2}), "force");
}

TEST(Reactions, OfCouplingsAgree) {
  print_head();
  std::map<std::string, std::map<std::string, Vector>> known;  // by run
  const auto force = [&](const std::string& what, const std::string& kind, double dt, const std::string& damping) {
    const std::string text = chain(damping, solver(kind, dt, 0.5));
    if (!known.contains(text)) {
      const TextRun run(text);
      known[text] = {{"right", run.vector("right")},
                     {"tissue", run.coupling("tissue", "force", "organ")},
                     {"seam", run.coupling("seam", "force")}};
    }
    return known[text][what];
  };
  for (const std::string damping : {"stiffness=\"0.2 s\"", "mass=\"20 Hz\""})
    for (const std::string what : {"right", "tissue", "seam"})
      expect_agreement(
          what + " " + damping.substr(0, damping.find('=')), 0.02, length(force(what, "midpoint", 0.02, "")),
          [&](const std::string& kind, double dt) { return force(what, kind, dt, "damping={" + damping + "}\n"); });
}

}  // namespace
}  // namespace fascia::test::reactions_test
