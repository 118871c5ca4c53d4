#include "app/scene/solver_words.hpp"
#include "app/schema/schema.hpp"
#include "core/solver/settings.hpp"

namespace fascia::app {
namespace {

constexpr double many = 1e9;

Shape newton_schema() {
  return table(
      {key("max_iterations", integer(between(1, many)), "Iterations of a step.").defaults("50"),
       key("tolerance", number("1", inside(0, 1)),
           "Residual relative to the largest load or inertia; to reactions too where a motion drives the body.")
           .defaults("1e-8"),
       key("on_limit",
           choice(
               {{"stop", "Cut the step, then stop with status 3."}, {"continue", "Go on with the residual reached."}}),
           "What happens at `max_iterations`.")
           .defaults("\"stop\"")});
}

template <class Words>
std::vector<Choice> choices_of(const Words& words) {
  std::vector<Choice> out;
  out.reserve(words.size());
  for (const auto& known : words) out.push_back({known.word, known.meaning});
  return out;
}

Shape linear_schema() {
  return table(
      {key("kind", choice(choices_of(kLinearSolvers)), "Linear solver.").defaults("\"auto\""),
       key("preconditioner", choice(choices_of(kPreconditioners)), "Preconditioner of conjugate gradients.")
           .defaults("\"auto\""),
       key("max_iterations", integer(between(1, many)), "Iterations of conjugate gradients.").defaults("1000"),
       key("tolerance", number("1", inside(0, 1)), "Relative residual of conjugate gradients.").defaults("1e-6")});
}

std::vector<Choice> controls() {
  return {{"load", "The load factor grows from 0 to 1."},
          {"displacement",
           "One displacement grows, and the load factor follows: through limit points, not through "
           "snap-back."},
          {"arc-length",
           "The path is followed by its length, the load factor may fall: through limit points and "
           "snap-back, to where it first is 1."}};
}

Shape controlled_schema() {
  return table({key("body", text("the name of a body"), "The body.").needed(),
                key("at", vector3("m"), "A material point by its rest position.").needed(),
                key("direction", vector3("1"), "Its displacement along this direction is prescribed.").needed(),
                key("to", number("m"), "Where the run ends; without it where the load factor first is 1.")});
}

std::vector<Choice> kinds() {
  return {{"static", "Equilibrium."},
          {"implicit-euler", "Dynamics, first order; damps motion."},
          {"bdf2", "Dynamics, second order; damps fast motion."},
          {"newmark", "Dynamics, second order; the trapezoidal rule, without damping of its own."},
          {"midpoint", "Dynamics, second order; the midpoint rule, without damping of its own."},
          {"explicit", "Dynamics, second order; central differences, stable up to a limit of the time step."},
          {"modes", "Natural frequencies."}};
}

}  // namespace

Key world_schema() {
  return key(
      "world",
      table({key("gravity", vector3("m/s2"), "Acceleration of free fall.").defaults("[0, 0, 0]"), over_key(),
             profile_key(), dial_key(),
             key("up", vector3("1"), "Direction that points up in pictures.")
                 .defaults("against gravity; without gravity z, or y where a picture's view is within 45 degrees "
                           "of the z axis")}),
      "The surroundings.");
}

Key solver_schema() {
  return key(
      "solver",
      table(
          {key("kind", choice(kinds()), "What is computed.").defaults("\"static\""),
           key("time_step",
               one_of({number("s", above(0)), choice({{"auto",
                                                       "Of `kind = \"explicit\"`: from the largest natural frequency, "
                                                       "which is followed through the run. Needs `duration`."}})}),
               "Of dynamics, where it is needed."),
           key("duration", number("s", above(0)), "Of dynamics; or `steps`."),
           key("steps", integer(between(1, many)), "Of dynamics; or `duration`. Not with `time_step = \"auto\"`."),
           key("budget", one_of({number("s", above(0)), choice({{"none", "A step takes as long as it needs."}})}),
               "Of implicit dynamics: time on the clock that a step may take. Where it ends, iterations do, and the "
               "step is taken as far as it got; the summary tells what was left.")
               .defaults("\"none\""),
           key("count", integer(between(1, 10000)), "Of `kind = \"modes\"`: how many.").defaults("10"),
           key("load_steps",
               one_of({choice({{"auto", "As few as converge; of `control` other than `\"load\"` as 10."}}),
                       integer(between(1, many))}),
               "Of `kind = \"static\"`; of `control` other than `\"load\"` the first step is as long as one of these, "
               "the others follow the path's need.")
               .defaults("\"auto\""),
           key("control", choice(controls()), "Of `kind = \"static\"`.").defaults("\"load\""),
           key("controlled", controlled_schema(),
               "Of `control = \"displacement\"`; without it the translation of a node that answers the loads most."),
           key("max_steps", integer(between(1, many)),
               "Of `control = \"displacement\"` and `\"arc-length\"`: the run gives up there.")
               .defaults("500"),
           key("newton", newton_schema(), "The non-linear solver; not of `kind = \"explicit\"`."),
           key("linear", linear_schema(), "The linear solver; not of `kind = \"explicit\"`."),
           key("tangent", choice({{"full", "With the geometric stiffness."}, {"material", "Without it."}}),
               "Stiffness of Newton's method; not of `kind = \"explicit\"`.")
               .defaults("\"full\""),
           key("imperfection", number("1", inside(0, 0.1)),
               "Of `kind = \"static\"`: small loads, growing with the others, that would bend the model at rest along "
               "its "
               "lowest natural mode by this part of the largest body. They set off what a perfect shape would not do."),
           key("accept",
               array(choice({{"unstable", "An equilibrium that the smallest disturbance makes the body leave."},
                             {"inverted", "An equilibrium in which matter is turned inside out."}})),
               "Of `kind = \"static\"` with `control = \"load\"`: ends that count as converged, with a warning; "
               "else they end the run with status `unstable` or `inverted`.")
               .defaults("[]"),
           key("precision",
               choice({{"double", "64 bits."},
                       {"mixed",
                        "Products with the stiffness of 32 bits; on the processor its entries, where conjugate "
                        "gradients solve."},
                       {"single", "Vectors of conjugate gradients of 32 bits too; needs the GPU."}}),
               "Arithmetic of Newton's directions; residuals and states are of 64 bits always. Not of `kind = "
               "\"explicit\"` and `\"modes\"`.")
               .defaults("\"double\""),
           key("backend",
               choice({{"auto", "The best there is."}, {"cpu", "The processor."}, {"cuda", "An NVIDIA GPU."}}),
               "Where it is computed.")
               .defaults("\"auto\""),
           key("gpus", integer(between(1, kMostDevices)),
               "GPUs of this machine that share the integration points of meshless solids; other models take one.")
               .defaults("1"),
           key("threads", integer(between(0, 4096)), "Threads of the processor; 0: as many as the process may run on.")
               .defaults("0"),
           later("accuracy", "Local error of implicit steps, which chooses their length.")},
          {{{"duration", "steps"}, false}}, "kind"),
      "How it is computed.");
}

}  // namespace fascia::app
