#include "core/executor/surface_tangent.hpp"

#include "core/base/index.hpp"
#include "core/math/rotation.hpp"
#include "core/structure/model.hpp"
#include "core/structure/surface_face.hpp"

#include <algorithm>
#include <array>

namespace fascia {

namespace {

/// A block that assembly fills; null where the pattern has none.
double* filled_block(BlockMatrix& matrix, int row, int column) {
  if (matrix.fills_upper() ? column < row : column > row) return nullptr;
  const int index = matrix.find(row, column);
  const std::span<const int> columns = matrix.columns(row);
  const std::size_t place = at(index - matrix.row_begin(row));
  return place < columns.size() && columns[place] == column ? matrix.block(index) : nullptr;
}

}  // namespace

void gather_forces(const SurfaceLoad& load, const std::vector<Vec3d>& force, const State& state, const DofLayout& dofs,
                   std::span<double> out) {
  for (int v = 0; v < load.vertex_count(); ++v) {
    const Vec3d& f = force[at(v)];
    for (const SurfaceShare& share : load.shares_of(v)) {
      add_share_force(share, dofs.kind(share.node), f, Mat3d::identity() + state.D[at(share.node)],
                      out.data() + dofs.begin(share.node));
    }
  }
}

void add_product(const SurfaceTangent& tangent, const DofLayout& dofs, const std::vector<Mat3d>& Q,
                 std::span<const double> x, std::span<double> y, TangentPart part) {
  const SurfaceLoad& load = *tangent.load;
  std::vector<Vec3d> dx(load.X.size()), force(load.X.size());
  for (int v = 0; v < load.vertex_count(); ++v)
    for (const SurfaceShare& share : load.shares_of(v)) {
      const double* d = x.data() + dofs.begin(share.node);
      dx[at(v)] += share_variation(share, dofs.kind(share.node), d, Q[at(share.node)]);
    }
  for (int f = 0; f < load.face_count(); ++f) {
    const SurfaceFace face = SurfaceFace::of(load, f);
    add_face_product(face, tangent.x.data(), tangent.pressure, tangent.gradient, dx.data(), part,
                     [&](int a, const Vec3d& term) { force[at(face.vertex[a])] += term; });
  }
  for (int v = 0; v < load.vertex_count(); ++v)
    for (const SurfaceShare& share : load.shares_of(v))
      add_share_force(share, dofs.kind(share.node), force[at(v)], Q[at(share.node)], y.data() + dofs.begin(share.node));
}

void add_product(const RankOne& update, std::span<const double> x, std::span<double> y) {
  double along = 0;
  for (std::size_t i = 0; i < x.size(); ++i) along += update.g[i] * x[i];
  along *= update.stiffness;
  for (std::size_t i = 0; i < x.size(); ++i) y[i] += update.g[i] * along;
}

void add_blocks(const SurfaceTangent& tangent, const std::vector<Mat3d>& Q, BlockMatrix& matrix) {
  const SurfaceLoad& load = *tangent.load;
  const DofLayout& dofs = matrix.dofs();
  FaceBlocks K;
  std::vector<int> nodes;                         // of a face
  std::vector<ShareColumns> J;                    // (nodes × vertices of the face)
  std::vector<char> moves;                        // likewise: J is not zero
  std::array<ShareColumns, kMostFaceNodes> pull;  // Σ K_ij J_j of one node, by vertices
  for (int f = 0; f < load.face_count(); ++f) {
    const std::span<const int> face = load.face(f);
    const std::size_t n = face.size();
    nodes.clear();
    J.clear();
    moves.clear();
    for (std::size_t i = 0; i < n; ++i)
      for (const SurfaceShare& share : load.shares_of(face[i])) {
        const auto known = std::find(nodes.begin(), nodes.end(), share.node);
        const auto k = static_cast<std::size_t>(known - nodes.begin());
        if (known == nodes.end()) {
          nodes.push_back(share.node);
          J.resize(J.size() + n);
          moves.resize(J.size(), 0);
        }
        J[k * n + i] = share_columns(share, dofs.kind(share.node), Q[at(share.node)]);
        moves[k * n + i] = 1;
      }
    face_blocks(SurfaceFace::of(load, f), tangent.x.data(), tangent.pressure, tangent.gradient, K);
    for (std::size_t b = 0; b < nodes.size(); ++b) {
      const int column = nodes[b], m = dofs.size(column);
      for (std::size_t i = 0; i < n; ++i)
        for (int k = 0; k < m; ++k) {
          pull[i][at(k)] = {};
          for (std::size_t j = 0; j < n; ++j)
            if (moves[b * n + j] != 0) pull[i][at(k)] += K[i][j] * J[b * n + j][at(k)];
        }
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        double* block = filled_block(matrix, nodes[a], column);
        if (block == nullptr) continue;
        for (std::size_t i = 0; i < n; ++i) {
          if (moves[a * n + i] == 0) continue;
          for (int l = 0; l < dofs.size(nodes[a]); ++l)
            for (int k = 0; k < m; ++k) block[m * l + k] += dot(J[a * n + i][at(l)], pull[i][at(k)]);
        }
      }
    }
  }
}

}  // namespace fascia
