#pragma once

#include "core/math/wrench.hpp"
#include "fascia/backend.hpp"
#include "fascia/rows.hpp"
#include "fascia/scene.hpp"

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

/// Simulation of a scene step by step, for programs that draw, drive or control it while it runs.
namespace fascia {

/// A rigid motion of places X at rest: x = center + R (X − center) + translation.
struct RigidMotion {
  Vec3d translation{};  ///< [m]
  Vec3d rotation{};     ///< rotation vector: axis times angle [rad]
  Vec3d center{};       ///< [m]
};

/// How a step went.
struct StepReport {
  bool converged = false;    ///< false: the state stayed as it was
  bool at_limit = false;     ///< it converged only in that Solver::on_limit = proceed accepts it above the tolerance
  bool out_of_time = false;  ///< Solver::budget ended before it converged, and it was taken as far as it got
  bool stopped = false;      ///< it did not converge, for it was asked to stop
  bool stable = true;        ///< false: an equilibrium of statics is unstable; true also where that could not be told
  std::string message;       ///< why it did not converge, and what to try; by the keys of scene files
  double time = 0;           ///< that was reached [s]; in statics the load factor
  double seconds = 0;        ///< that the step took
  double residual = 0;       ///< largest that was left, as a part of the forces that act [-]
  int newton_iterations = 0, linear_iterations = 0;
};

/// A state to which a stepper can return. Copies share it.
class Snapshot {
 public:
  Snapshot() = default;

 private:
  friend class Stepper;
  struct Data;
  std::shared_ptr<const Data> data_;
};

/// Builds what a scene describes and advances it on demand.
///
/// Statics and the implicit schemes of Solver::kind can be stepped, on the processor or, with Solver::backend = "cuda",
/// on a GPU. Solver::time_step, Solver::steps, Solver::duration and Output are not used, but where there is a
/// Solver::budget: steps of Solver::time_step are tried then, and forgotten. A call that throws InputError
/// changes nothing. One stepper is used by one thread at a time; several may be used side by side.
///
/// The address of a view stays the same as long as the stepper lives; its numbers are those of the last step. Nobody
/// reads them while step() or restore() runs.
class Stepper {
 public:
  /// @throws SceneError    what is wrong with the scene: the place is the key of the field
  /// @throws FileError, InputError  meshes
  /// @throws BackendError  a GPU that was asked for and is not there, lacks memory, or does not compute the scene
  explicit Stepper(Scene scene);
  ~Stepper();
  Stepper(Stepper&&) noexcept;
  Stepper& operator=(Stepper&&) noexcept;

  /// Advances by dt [s], which may differ from step to step; in statics the load factor by dt: all loads grow until it
  /// is 1, and stay. What follows a step that failed is as though it had not been tried; but forces
  /// of supports of scattered frames start anew in midpoint steps, and so do schemes after a call that throws.
  /// @param stop  asked before each iteration of Newton's method: a step that is told to stop is one that failed; one
  ///              that needs no further iteration ends as usual
  /// @throws InputError    a step that is not above 0, or lost beside the time; a fluid that a dial leaves no volume
  /// @throws BackendError  a device that is lost, or has no memory left; this and what reads the state
  StepReport step(double dt, const std::stop_token& stop = {});
  double time() const;  ///< [s]; in statics the load factor
  Backend backend() const;
  /// Sentences on what should be known of the scene although nothing is wrong.
  std::vector<std::string> warnings() const;

  /// The number of the driver that constraints name (Constraint::driver). @throws InputError  none does
  int driver(std::string_view name) const;
  /// Says where a driver takes its region in the next step; it stays there until it is told otherwise. On the way it
  /// turns evenly, the shorter way round, and its center moves straight. After a step that failed the driver stands
  /// where it stood before, and is to be told anew.
  void set_motion(int driver, const RigidMotion& motion);
  /// Where a driver is now; what it was told last shows after the step.
  RigidMotion motion(int driver) const;
  /// Force and moment that a driver exerts on what it moves, with weight and inertia, in the axes in which it moves it;
  /// the hand that holds it feels the opposite. Like forces(), they are those that led to the present state; where
  /// neither was asked for before a step that failed, those of that state at rest.
  /// @param about  of the moment [m]; left out: where the driver's center is now
  /// @throws StateError  they are not finite
  Wrench driver_force(int driver, const std::optional<Vec3d>& about = {});

  /// The number of the dial that loads, motions, fluids or gravity name (Schedule::dial).
  /// @throws InputError  none that acts does
  int dial(std::string_view name) const;
  /// Says by what the next step multiplies the factors of the schedules that name the dial, at its end; on the way
  /// there it changes evenly from its present value, which is 1 before the first step. It stays until it is told
  /// otherwise; after a step that failed it is what it was before, and is to be told anew.
  void set_dial(int dial, double value);
  /// The value of a dial now; what it was told last shows after the step.
  double dial_value(int dial) const;

  int body(std::string_view name) const;  ///< the number of a body, in the order of the scene
  int node_count() const;                 ///< rows of the views of nodes, those of a body one after the other
  int first_node(int body) const;
  int node_count(int body) const;

  Rows displacements();  ///< u (nodes × 3) [m]
  Rows velocities();     ///< (nodes × 3) [m/s]
  Rows positions();      ///< (nodes × 3) [m]
  Rows rotations();      ///< Q of frames since rest, by rows; I + F − I of affine ones, I of vertices (nodes × 9)
  /// Forces of constraints on the nodes that they hold or move, with weight and inertia (nodes × 3) [N]; where they
  /// hold the material of scattered frames, on the nearest frame. A snapshot, a return to it and a step that failed do
  /// not change them.
  Rows forces();

  /// The surface of a body: corners of its triangles, as rows of surface_points(), and the places of these. A line has
  /// points alone; the surface of a shell is its middle.
  std::span<const std::array<int, 3>> surface_triangles(int body) const;
  Rows surface_points(int body);  ///< (points × 3) [m]

  /// How many integration points of a body are turned inside out: above 0 its state is not physical, though some laws
  /// have an equilibrium there. A run in statics ends as "inverted".
  int inverted_points(int body);

  /// The value of a probe of the scene: one number, 3, 9 by rows, or as many for each of its places.
  /// @throws StateError  a value is not finite
  std::vector<double> probe(std::string_view name);

  /// Keeps the state, to which this stepper may return any number of times. What follows is the same bit for bit, for
  /// preconditioners are made anew after both.
  Snapshot snapshot();
  /// @throws InputError  an empty snapshot, or one of another stepper
  void restore(const Snapshot& snapshot);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace fascia
