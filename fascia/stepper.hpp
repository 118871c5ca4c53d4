#pragma once

#include "fascia/backend.hpp"
#include "fascia/rows.hpp"
#include "fascia/scene.hpp"

#include <array>
#include <memory>
#include <span>
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
  bool converged = false;  ///< false: the state stayed as it was
  bool at_limit = false;   ///< it was accepted above the tolerance, as Solver::on_limit = proceed asks
  bool stable = true;      ///< of statics: no soft direction was found in which the equilibrium is unstable
  std::string message;     ///< why it did not converge, and what to try
  double time = 0;         ///< that was reached [s]; in statics the load factor
  double seconds = 0;      ///< that the step took
  double residual = 0;     ///< largest of the step, of what acts [-]
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
/// on a GPU. Solver::time_step and Solver::steps are not used. A call that is refused, by an exception of type
/// InputError with a sentence, changes nothing. One stepper is used by one thread at a time.
///
/// The address of a view stays the same as long as the stepper lives; its numbers are those of the last step. Nobody
/// reads them while step() or restore() runs.
class Stepper {
 public:
  /// @throws SceneError    what is wrong with the scene: the place is the key of the field
  /// @throws FileError, InputError  meshes
  /// @throws BackendError  a GPU that was asked for and is not there
  explicit Stepper(Scene scene);
  ~Stepper();
  Stepper(Stepper&&) noexcept;
  Stepper& operator=(Stepper&&) noexcept;

  /// Advances by dt [s]; in statics the load factor by dt: loads without a schedule act whole from 1 on. What fades or
  /// oscillates is followed as the scheme does; a step after one that failed knows no step before.
  /// @throws BackendError  a device that is lost, or has no memory left
  StepReport step(double dt);
  double time() const;  ///< [s]; in statics the load factor
  Backend backend() const;
  /// Sentences on what should be known of the scene although nothing is wrong.
  std::vector<std::string> warnings() const;

  /// The number of the driver that constraints name (Constraint::driver).
  int driver(std::string_view name) const;
  /// Says where a driver takes its region in the next step; it stays there until it is told otherwise. On the way it
  /// turns evenly, the shorter way round, and its center moves straight. After a step that failed the driver stands
  /// where it stood before, and is to be told anew.
  void set_motion(int driver, const RigidMotion& motion);
  /// Where a driver is.
  RigidMotion motion(int driver) const;

  int body(std::string_view name) const;  ///< the number of a body, in the order of the scene
  /// Nodes of all bodies [m], as rows: those of a body come one after the other.
  int node_count() const;
  int first_node(int body) const;
  int node_count(int body) const;

  Rows displacements();  ///< u (nodes × 3) [m]
  Rows velocities();     ///< (nodes × 3) [m/s]
  Rows positions();      ///< (nodes × 3) [m]
  Rows rotations();      ///< Q of frames since rest, by rows; I + F − I of affine ones, I of vertices (nodes × 9)
  /// Forces with which constraints hold or move nodes (nodes × 3) [N]; where they hold the material of scattered
  /// frames, on the nearest frame.
  Rows forces();

  /// The surface of a body, for drawing and for contact: corners of its triangles, and the places of its points.
  std::span<const std::array<int, 3>> surface_triangles(int body) const;
  Rows surface_points(int body);  ///< (points × 3) [m]

  /// Integration points of a body that are turned inside out: with the laws of some elements an equilibrium, and no
  /// state of matter. A run in statics ends as "inverted" there.
  int inverted_points(int body);

  /// The value of a probe of the scene: one number, 3, 9 by rows, or as many for each of its places.
  /// @throws StateError  a value is not finite
  std::vector<double> probe(std::string_view name);

  /// Preconditioners are made anew after a snapshot, so that what follows it is the same, bit for bit, as what follows
  /// restore().
  Snapshot snapshot();
  void restore(const Snapshot& snapshot);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace fascia
