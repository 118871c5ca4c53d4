#pragma once

#include "core/linear/cg.hpp"
#include "core/physics/point_physics.hpp"
#include "gpu/tiles/tile_layout.hpp"

#include <memory>
#include <span>
#include <vector>

namespace fascia {

/// Sums over all points [J].
struct TileEnergy {
  double elastic = 0, stabilization = 0, viscous = 0;
};

/// How weights, gradients, places and volumes are stored: all arithmetic is in double, and all that a solver computes
/// uses the same constants, so that products stay the derivatives of forces. Rounded to float they are those of a model
/// that differs by 1e-7.
enum class TileConstants : unsigned char { float64, float32 };

struct TileSolverSettings {
  TileConstants constants = TileConstants::float64;
  bool resident = true;  ///< small problems are solved in one launch
  int tile_size = 0;     ///< of large problems: 64, 128 or 256; 0: by experience
  /// GPUs that share the points, none in one launch; the first holds the vectors. Empty: the present one.
  std::vector<int> devices{};
};

/// Solids of rigid frames on a GPU: energies, forces and the tangent of a tiled point set, and CG that never waits for
/// the host. Pointers are to the device, vectors by node as in DofLayout (6 a node), poses u (nodes × 3) and
/// D = Q − I (nodes × 9, by rows). Calls are in the order of the default stream; results do not change from run to run.
/// CUDA errors are thrown as std::runtime_error.
class TileSolver {
 public:
  /// Null where tiles cannot hold the points (make_tiles()).
  /// @throws gpu::NotShared  devices that cannot read each other's memory, or more of them than tiles
  static std::unique_ptr<TileSolver> make(const TilePoints& points, const TileSolverSettings& settings,
                                          ThreadPool& pool);
  virtual ~TileSolver() = default;
  TileSolver(const TileSolver&) = delete;
  TileSolver& operator=(const TileSolver&) = delete;

  /// Keeps the strains of a state: the start of a time step, for stiffness damping.
  virtual void store_strain(const double* u, const double* D) = 0;

  /// Gradient of the internal energy (overwritten).
  /// @param inverse_step  1/dt of the viscous stress [1/s]; 0: none
  /// @param moments       (nodes × 9) N of each frame, conjugate to Q, by rows; or null. Its rotation-rotation tangent
  ///                      is sym(L) − tr(L) I, L = N Qᵀ
  virtual void forces(const double* u, const double* D, double inverse_step, double* gradient, double* moments) = 0;
  /// Gradient of the internal energy (overwritten) like forces(), with energies.
  virtual TileEnergy gradient(const double* u, const double* D, double inverse_step, double* gradient,
                              double* moments) = 0;

  /// Keeps the tangent of the points at a state.
  virtual void linearize(const double* u, const double* D, Tangent tangent, double inverse_step) = 0;
  /// Sets the tangent of what acts on one frame alone, symmetric: (nodes × 36), kept; null: none.
  virtual void set_node_blocks(const double* blocks) = 0;
  /// Degrees of freedom that stay zero: bit i of a node holds its i-th, in world axes. By node, on the host; empty:
  /// none.
  virtual void set_held(std::span<const std::uint8_t> held) = 0;
  /// Inverse own blocks of the present tangent, node blocks and held degrees of freedom. Before: the identity.
  virtual void build_preconditioner() = 0;
  virtual void clear_preconditioner() = 0;

  /// y = K x; rows of held degrees of freedom are zero.
  virtual void multiply(const double* x, double* y) = 0;
  /// CG as conjugate_gradients(), from x = 0.
  virtual CgReport solve(const double* b, double* x, const CgOptions& options) = 0;
  /// Starts solve() without waiting for it; finish_solve() waits.
  virtual void start_solve(const double* b, double* x, const CgOptions& options) = 0;
  virtual CgReport finish_solve() = 0;

  virtual const TileLayout& layout() const = 0;  ///< without the arrays of constants
  virtual bool resident() const = 0;             ///< solves in one launch

 protected:
  TileSolver() = default;
};

}  // namespace fascia
