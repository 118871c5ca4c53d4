#pragma once

#include "gpu/tiles/tile_memory.cuh"
#include "gpu/tiles/tile_resident.cuh"
#include "gpu/tiles/tile_solver.hpp"
#include "gpu/tiles/tile_state_kernels.cuh"
#include "gpu/tiles/tile_team.cuh"

#include <optional>

namespace fascia::tile {

/// Iterations of CG that a graph runs between two looks at the residual; even, as p alternates between two buffers.
inline constexpr int kLoopIterations = 10;

struct DeviceLimits {
  int multiprocessors = 0, shared_bytes = 0;
  static DeviceLimits present();
};

/// Offsets of parts in shared memory, each on 16 bytes.
class Carver {
 public:
  int take(std::size_t bytes) {
    const int begin = next_;
    next_ += static_cast<int>((bytes + 15) / 16 * 16);
    return begin;
  }
  int bytes() const { return next_; }

 private:
  int next_ = 0;
};

template <class Constant>
SharedPlan shared_plan(const TileLayout& layout);

template <class Constant>
ResidentPlan resident_plan(const TileLayout& layout);

/// A TileSolver whose constants are of one type.
template <class Constant>
class Solver final : public TileSolver {
 public:
  /// On the present device. @param resident  the plan of a layout whose tiles stay on chip
  Solver(TileShare share, std::optional<ResidentPlan> resident, const DeviceLimits& limits,
         cudaStream_t stream = nullptr);
  ~Solver() override;

  void store_strain(const double* u, const double* D) override;
  void forces(const double* u, const double* D, double inverse_step, double* gradient, double* moments) override;
  TileEnergy gradient(const double* u, const double* D, double inverse_step, double* gradient,
                      double* moments) override;
  void linearize(const double* u, const double* D, Tangent tangent, double inverse_step) override;
  void set_node_blocks(const double* blocks) override;
  void set_held(std::span<const std::uint8_t> held) override;
  void build_preconditioner() override;
  void clear_preconditioner() override;
  void multiply(const double* x, double* y) override;
  CgReport solve(const double* b, double* x, const CgOptions& options) override;
  void start_solve(const double* b, double* x, const CgOptions& options) override;
  CgReport finish_solve() override;
  const TileLayout& layout() const override { return layout_; }
  bool resident() const override { return resident_.has_value(); }

  /// Makes it one of several that compute a problem: `team[rank]`. Each has a stream of its own.
  void join(std::span<const std::unique_ptr<Solver>> team, int rank);
  /// Makes ahead what must not be made while another device waits for this one.
  void prepare_solve() { build_graph(); }
  void prepare_forces() { gradient_partials_.resize(at(layout_.slot_count()) * kGradient); }
  /// gradient() without waiting, and its energies.
  void start_gradient(const double* u, const double* D, double inverse_step, double* gradient, double* moments);
  TileEnergy finish_gradient();

 private:
  using ProductKernel = void (*)(ProductArgs<Constant>);
  using StateKernel = void (*)(StateArgs<Constant>);
  using ResidentKernel = void (*)(ResidentArgs<Constant>);

  void upload();
  void choose_kernels(const DeviceLimits& limits);
  void run_state(const double* u, const double* D, StateArgs<Constant> args);
  StateArgs<Constant> state_args(double inverse_step) const;
  ProductArgs<Constant> product_args() const;
  VectorArgs vector_args() const;
  CgState options_state(const CgOptions& options) const;
  void launch_product(const ProductArgs<Constant>& args, cudaStream_t stream);
  void launch_iterations(cudaStream_t stream, cudaGraphConditionalHandle loop);
  void build_graph();
  void drop_graph();
  /// Rows go to the others of the team and a sum to all of them; nothing where it is alone.
  void meet(const RowsArgs& rows, const SumArgs& sum, cudaStream_t stream);
  RowsArgs rows_of(const Buffer<TileExport>& exports, int words, Buffer<double> Solver::*rows) const;
  RowsArgs partial_rows() const { return rows_of(partial_exports_, kDofs, &Solver::partials_); }
  bool alone() const { return team_.size == 1; }
  /// Where sums over all frames stand, and in how many parts.
  const double* residual_sums() const { return alone() ? rz_parts_.get() : sums_.get() + 1; }
  int residual_count() const { return alone() ? update_blocks_ : 1; }
  const double* curvature_sums() const { return alone() ? curvature_parts_.get() : sums_.get(); }
  int curvature_count() const { return alone() ? product_blocks_ : 1; }
  /// Copies of the host were made on the default stream.
  void wait_for_copies() const;
  void sum_forces(double* gradient, double* moments);
  int frame_blocks() const { return (layout_.frame_count + kUpdateThreads - 1) / kUpdateThreads; }
  int words() const { return layout_.drilling ? kPointWords<true> : kPointWords<false>; }

  TileShare share_;
  TileLayout& layout_ = share_.layout;
  cudaStream_t stream_;
  std::optional<ResidentPlan> resident_;
  SharedPlan plan_;
  DeviceTiles<Constant> tiles_{};
  Tangent tangent_ = Tangent::full;
  double inverse_step_ = 0;
  bool has_node_blocks_ = false, has_held_ = false;

  ProductKernel product_ = nullptr;
  StateKernel state_ = nullptr;
  ResidentKernel resident_kernel_ = nullptr;
  void (*jacobi_)(ProductArgs<Constant>, JacobiArgs) = nullptr;
  int threads_ = 0, resident_threads_ = 0, product_blocks_ = 0, state_blocks_ = 0, update_blocks_ = 0;

  Buffer<Constant> weights_, places_;
  Buffer<std::uint16_t> material_, list_, list_begin_;
  Buffer<std::uint8_t> local_, held_;
  Buffer<int> tile_frame_begin_, frame_node_, frame_slot_begin_, slot_tile_, slot_tile_frame_;
  Buffer<TileFrame> tile_frames_;
  Buffer<TileHead> head_;
  Buffer<TileMaterial> materials_;

  Buffer<double> rest_, pose_, motion_, points_, strain_, node_blocks_;
  Buffer<float> inverse_;
  Buffer<double> x_, r_, z_, p_, q_;  ///< p and q: directions of even and odd iterations
  Buffer<double> partials_, gradient_partials_, rz_parts_, curvature_parts_, energy_parts_, dots_;
  Buffer<CgState> cg_;  ///< two for CG in turn, one for products, one for the end
  cudaGraphExec_t graph_ = nullptr;

  TeamView team_{};
  std::vector<Solver*> members_;  ///< of the team, by rank
  Buffer<TileExport> partial_exports_, block_exports_;
  Buffer<int> shared_place_;  ///< (frames) where a frame's own block goes, or −1; empty where alone
  Buffer<int> shared_, shared_block_begin_;
  Buffer<double> blocks_;  ///< own blocks of shared frames, of each share that touches them
  Buffer<double> sums_;    ///< p · K p and r · z of all devices
  Buffer<std::uint64_t> words_;
  Buffer<unsigned> meetings_, arrived_;
};

}  // namespace fascia::tile
