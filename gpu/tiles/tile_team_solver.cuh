#pragma once

#include "gpu/tiles/tile_solver_impl.cuh"

#include <memory>
#include <vector>

/// Several devices that solve one problem.
namespace fascia::tile {

/// The present device while it lasts.
class OnDevice {
 public:
  explicit OnDevice(int device) {
    check(cudaGetDevice(&before_), "looking at the device");
    check(cudaSetDevice(device), "taking a device");
  }
  ~OnDevice() { cudaSetDevice(before_); }
  OnDevice(const OnDevice&) = delete;
  OnDevice& operator=(const OnDevice&) = delete;

 private:
  int before_ = 0;
};

/// Lets every device of a list read and write the memory of the others. @throws NotShared
void connect_devices(std::span<const int> devices);

/// A stream of a device, and the event that others wait for.
class TeamStream {
 public:
  explicit TeamStream(int device);
  ~TeamStream();
  TeamStream(const TeamStream&) = delete;
  TeamStream& operator=(const TeamStream&) = delete;

  cudaStream_t get() const { return stream_; }
  void follow(cudaEvent_t event) { check(cudaStreamWaitEvent(stream_, event), "waiting for the first GPU"); }
  /// Everything so far.
  cudaEvent_t reached() {
    check(cudaEventRecord(event_, stream_), "recording an event");
    return event_;
  }
  cudaEvent_t event() const { return event_; }

 private:
  int device_;
  cudaStream_t stream_ = nullptr;
  cudaEvent_t event_ = nullptr;
};

/// Shares of a layout on devices, the first of which holds the vectors of calls. Calls are in the order of that
/// device's default stream, as those of a Solver.
template <class Constant>
class TeamSolver final : public TileSolver {
 public:
  TeamSolver(TileLayout layout, std::span<const int> devices);
  ~TeamSolver() override;

  void store_strain(const double* u, const double* D) override {
    for_each([&](Ranked& s) { s.store_strain(u, D); });
  }
  void forces(const double* u, const double* D, double inverse_step, double* gradient, double* moments) override {
    for_each([](Ranked& s) { s.prepare_forces(); });
    for_each([&](Ranked& s) { s.forces(u, D, inverse_step, gradient, moments); });
  }
  TileEnergy gradient(const double* u, const double* D, double inverse_step, double* gradient,
                      double* moments) override {
    for_each([](Ranked& s) { s.prepare_forces(); });
    for_each([&](Ranked& s) { s.start_gradient(u, D, inverse_step, gradient, moments); });
    TileEnergy sum;
    for_each([&](Ranked& s) {
      const TileEnergy own = s.finish_gradient();
      sum.elastic += own.elastic;
      sum.stabilization += own.stabilization;
      sum.viscous += own.viscous;
    });
    return sum;
  }
  void linearize(const double* u, const double* D, Tangent tangent, double inverse_step) override {
    for_each([&](Ranked& s) { s.linearize(u, D, tangent, inverse_step); });
  }
  void set_node_blocks(const double* blocks) override {
    for_each([&](Ranked& s) { s.set_node_blocks(blocks); });
  }
  void set_held(std::span<const std::uint8_t> held) override {
    for_each([&](Ranked& s) { s.set_held(held); });
  }
  void build_preconditioner() override {
    for_each([](Ranked& s) { s.build_preconditioner(); });
  }
  void clear_preconditioner() override {
    for_each([](Ranked& s) { s.clear_preconditioner(); });
  }
  void multiply(const double* x, double* y) override {
    for_each([&](Ranked& s) { s.multiply(x, y); });
  }
  CgReport solve(const double* b, double* x, const CgOptions& options) override {
    start_solve(b, x, options);
    return finish_solve();
  }
  void start_solve(const double* b, double* x, const CgOptions& options) override {
    for_each([](Ranked& s) { s.prepare_solve(); });
    for_each([&](Ranked& s) { s.start_solve(b, x, options); });
  }
  CgReport finish_solve() override {
    const OnDevice on(devices_[0]);
    return ranks_[0]->finish_solve();
  }
  const TileLayout& layout() const override { return ranks_[0]->layout(); }
  bool resident() const override { return false; }

 private:
  using Ranked = Solver<Constant>;

  /// On every device, behind what was asked of the first one; what is asked of that one later comes behind it.
  template <class Act>
  void for_each(const Act& act) {
    check(cudaEventRecord(start_, cudaStreamLegacy), "recording an event");
    for (std::size_t i = 0; i < ranks_.size(); ++i) {
      const OnDevice on(devices_[i]);
      streams_[i]->follow(start_);
      act(*ranks_[i]);
      streams_[i]->reached();
    }
    for (const auto& stream : streams_)
      check(cudaStreamWaitEvent(cudaStreamLegacy, stream->event()), "waiting for a GPU");
  }

  std::vector<int> devices_;
  std::vector<std::unique_ptr<TeamStream>> streams_;
  std::vector<std::unique_ptr<Ranked>> ranks_;
  cudaEvent_t start_ = nullptr;
};

}  // namespace fascia::tile
