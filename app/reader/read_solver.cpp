#include "app/reader/readers.hpp"
#include "app/scene/solver_words.hpp"
#include "assembly/specification/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

void read_newton(const TableReader& newton, Solver& solver) {
  solver.newton_max_iterations = newton.integer("max_iterations").value_or(solver.newton_max_iterations);
  solver.newton_tolerance = newton.number("tolerance").value_or(solver.newton_tolerance);
  if (newton.text("on_limit") == "continue") solver.on_limit = OnLimit::proceed;
}

void read_linear(const TableReader& linear, Solver& solver) {
  solver.linear = kind_of(kLinearSolvers, linear.text("kind").value_or(""));
  solver.preconditioner = kind_of(kPreconditioners, linear.text("preconditioner").value_or(""));
  solver.linear_max_iterations = linear.integer("max_iterations").value_or(solver.linear_max_iterations);
  solver.linear_tolerance = linear.number("tolerance").value_or(solver.linear_tolerance);
}

int steps_of(const TableReader& table, double duration, double time_step) {
  const double steps = step_count(duration, time_step);
  if (steps <= 1e9) return static_cast<int>(steps);
  table.error("duration", fmt::format("takes {:.3g} steps of {} s; must take at most 1e9", steps, time_step));
  return 1;
}

/// A time step that the run finds: how many steps it takes is open.
void read_automatic_time(const TableReader& table, Solver& solver) {
  if (solver.kind != SolverKind::central_differences)
    return table.error("time_step", "\"auto\" is only for kind = \"explicit\"; must be a time in s above 0");
  solver.time_step_automatic = true;
  if (table.has("duration")) return;
  if (table.has("steps"))
    table.error("steps", "is not used with time_step = \"auto\", whose steps the run counts; must be duration");
  else
    table.error("duration", "is missing beside time_step = \"auto\"; must be a time in s above 0");
}

/// A time step that a need chooses; until then one stands for it.
void read_open_time(const TableReader& table, Solver& solver) {
  constexpr int steps = 32;
  if (table.has("steps"))
    table.error("steps", "says nothing without time_step, which the need chooses; must be duration");
  else if (!table.has("duration"))
    table.error("duration", "is missing; must be a time in s above 0");
  solver.step_open = true;
  solver.steps = steps;
  solver.time_step = solver.duration.value_or(1) / steps;
}

void read_time(const TableReader& table, bool under_need, Solver& solver) {
  solver.duration = table.number("duration");
  const Value* time_step = table.value("time_step");
  if (time_step && time_step->as_string()) return read_automatic_time(table, solver);
  const char* automatic = solver.kind == SolverKind::central_differences ? " or \"auto\"" : "";
  if (!table.has("time_step") && under_need) return read_open_time(table, solver);
  if (!table.has("time_step"))
    table.error("time_step", fmt::format("is missing; must be a time in s above 0{}{}", automatic, kNeedWouldChoose));
  if (!table.has("duration") && !table.has("steps"))
    table.error("duration", "is missing; must be a time in s above 0, or give steps");
  solver.time_step = table.number("time_step").value_or(0);
  solver.steps = table.integer("steps").value_or(1);
  if (solver.duration && solver.time_step > 0) solver.steps = steps_of(table, *solver.duration, solver.time_step);
}

/// A displacement to control, of the keys of path following.
std::optional<ControlledDisplacement> read_controlled(const TableReader& solver,
                                                      const std::vector<std::string>& bodies) {
  const TableReader table = solver.table("controlled");
  if (!table.usable()) return std::nullopt;
  ControlledDisplacement controlled;
  controlled.body = read_body_name(table, bodies);
  controlled.at = table.vector("at").value_or(Vec3d{});
  controlled.at_place = table.place("at");
  controlled.direction = table.direction("direction").value_or(Vec3d{});
  controlled.to = table.number("to");
  if (controlled.to && *controlled.to == 0)
    table.error("to", "0 is where the run starts; must be a length in m other than 0");
  return controlled;
}

/// How a static path is followed, and what does not go with that.
void read_control(const TableReader& table, const std::vector<std::string>& bodies, Solver& solver) {
  const std::string control = table.text("control").value_or("load");
  solver.max_steps = table.integer("max_steps").value_or(solver.max_steps);
  if (control != "displacement")
    table.refuse({"controlled"}, "is used only with control = \"displacement\"");
  else
    solver.controlled = read_controlled(table, bodies);
  if (control != "load") table.refuse({"accept"}, "is used only with control = \"load\"; a followed path goes on");
  if (control == "load")
    return table.refuse({"max_steps"}, "is used only with control = \"displacement\" or \"arc-length\"");
  solver.control = control == "displacement" ? StaticControl::displacement : StaticControl::arc_length;
  const std::string with = fmt::format("does not go with control = \"{}\"", control);
  const TableReader linear = table.table("linear"), newton = table.table("newton");
  if (linear.text("kind") == "cg")
    linear.error("kind",
                 fmt::format("\"cg\" {}, which factorises the stiffness; must be \"auto\" or \"cholesky\"", with));
  if (newton.text("on_limit") == "continue")
    newton.error("on_limit", fmt::format("\"continue\" {}; must be \"stop\"", with));
  if (table.text("tangent") == "material")
    table.error("tangent", fmt::format("\"material\" {}, which needs the geometric stiffness; must be \"full\"", with));
}

/// Time on the clock for a step. A need measures what models take, and not what is left of them when time ends.
void read_budget(const TableReader& table, bool under_need, Solver& solver) {
  const Value* budget = table.value("budget");
  if (!budget || budget->as_string()) return;
  solver.budget = table.number("budget");
  if (under_need)
    table.error("budget", "does not go with a need; leave it out: need.step chooses a model whose steps take so long");
}

/// Products of 32 bits are those of solvers with Newton's directions, vectors of 32 bits the GPU's.
void read_precision(const TableReader& table, Solver& solver) {
  solver.precision = table.text("precision").value_or("double");
  if (solver.precision == "double") return;
  const std::string asked = fmt::format("\"{}\"", solver.precision);
  if (solver.kind == SolverKind::central_differences || solver.kind == SolverKind::modes)
    return table.error("precision", fmt::format("{} is not used by kind = \"{}\"; must be \"double\"", asked,
                                                table.text("kind").value_or("static")));
  if (solver.backend == "cpu" && solver.precision == "single")
    table.error("precision", fmt::format("{} needs the GPU; must be \"double\" or \"mixed\", or backend \"auto\" or "
                                         "\"cuda\"",
                                         asked));
}

/// Several GPUs share Newton's directions.
void read_gpus(const TableReader& table, Solver& solver) {
  solver.gpus = table.integer("gpus").value_or(1);
  if (solver.gpus == 1) return;
  if (solver.kind == SolverKind::central_differences || solver.kind == SolverKind::modes)
    return table.error("gpus", fmt::format("{} is not used by kind = \"{}\"; must be 1", solver.gpus,
                                           table.text("kind").value_or("static")));
  if (solver.backend == "cpu")
    return table.error("gpus", fmt::format("{} does not go with backend = \"cpu\"; must be 1, or backend \"auto\" or "
                                           "\"cuda\"",
                                           solver.gpus));
  if (solver.precision == "single")
    table.error("gpus", fmt::format("{} does not go with precision = \"single\"; must be 1, or precision \"double\" or "
                                    "\"mixed\"",
                                    solver.gpus));
}

/// Keys that only some kinds use.
void check_kind(const TableReader& table, const Solver& solver) {
  const std::string unused = fmt::format("is not used by kind = \"{}\"", table.text("kind").value_or("static"));
  if (!is_dynamic(solver.kind)) table.refuse({"time_step", "duration", "steps"}, unused);
  if (solver.kind != SolverKind::statics)
    table.refuse({"load_steps", "control", "controlled", "max_steps", "accept", "imperfection"}, unused);
  if (solver.kind != SolverKind::modes) table.refuse({"count"}, unused);
  if (!is_implicit_dynamics(solver.kind))
    table.refuse({"budget"}, unused + "; a budget is for steps of implicit dynamics, which can be cut short");
  if (solver.kind == SolverKind::central_differences) table.refuse({"newton", "linear", "tangent"}, unused);
}

}  // namespace

World read_world(const TableReader& scene) {
  const TableReader world = scene.table("world");
  return {world.vector("gravity").value_or(Vec3d{}), read_schedule(world), world.direction("up")};
}

std::optional<SolverKind> read_solver_kind(const TableReader& scene) {
  const TableReader solver = scene.table("solver");
  const bool wrong = (scene.has("solver") && !solver.exists()) || (solver.has("kind") && !solver.value("kind"));
  if (wrong) return std::nullopt;
  // Of a scheme that is left to a need it only matters that it is one of dynamics.
  const bool chosen = states_need(scene) && !solver.has("kind") && solver.has("duration");
  const std::string kind = solver.text("kind").value_or(chosen ? "newmark" : "static");
  if (kind == "implicit-euler") return SolverKind::implicit_euler;
  if (kind == "bdf2") return SolverKind::bdf2;
  if (kind == "newmark") return SolverKind::newmark;
  if (kind == "midpoint") return SolverKind::midpoint;
  if (kind == "explicit") return SolverKind::central_differences;
  if (kind == "modes") return SolverKind::modes;
  return SolverKind::statics;
}

Solver read_solver(const TableReader& scene, const std::vector<std::string>& bodies) {
  const TableReader table = scene.table("solver");
  Solver solver;
  solver.place = table.place();
  solver.time_step_place = table.place("time_step");
  const std::optional<SolverKind> kind = read_solver_kind(scene);
  solver.kind = kind.value_or(SolverKind::statics);
  if (kind) check_kind(table, solver);
  solver.scheme_open = states_need(scene) && !table.has("kind") && is_dynamic(solver.kind);
  if (is_dynamic(solver.kind)) read_time(table, states_need(scene), solver);
  if (const Value* load_steps = table.value("load_steps"); load_steps && !load_steps->as_string())
    solver.load_steps = *table.integer("load_steps");
  if (kind == SolverKind::statics) read_control(table, bodies, solver);
  solver.modes = table.integer("count").value_or(solver.modes);
  read_budget(table, states_need(scene), solver);
  read_newton(table.table("newton"), solver);
  read_linear(table.table("linear"), solver);
  solver.imperfection = table.number("imperfection").value_or(0);
  solver.imperfection_place = table.place("imperfection");
  if (const Value* accepted = table.value("accept"))
    for (const Value& item : *accepted->as_array())
      (*item.as_string() == "unstable" ? solver.accept_unstable : solver.accept_inverted) = true;
  solver.full_tangent = table.text("tangent").value_or("full") == "full";
  solver.backend = table.text("backend").value_or("auto");
  read_precision(table, solver);
  read_gpus(table, solver);
  solver.threads = table.integer("threads").value_or(0);
  return solver;
}

}  // namespace fascia::app
