#include "core/executor/surface_blocks.hpp"

#include "core/base/index.hpp"
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

/// @param x  of the surface's vertices
void add_blocks(const SurfaceLoad& load, const Vec3d* x, double pressure, const Vec3d& gradient,
                const std::vector<Mat3d>& Q, BlockMatrix& matrix) {
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
    face_blocks(SurfaceFace::of(load, f), x, pressure, gradient, K);
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

}  // namespace

void add_blocks(std::span<const SurfaceLoad> loads, const SurfaceTangent<PoolSpace>& tangent,
                const std::vector<Mat3d>& Q, BlockMatrix& matrix) {
  if (!tangent.curved) return;
  const Vec3d* x = tangent.x.data();
  for (std::size_t s = 0; s < loads.size(); ++s) {
    add_blocks(loads[s], x, tangent.pressure.data()[s], tangent.gradient.data()[s], Q, matrix);
    x += loads[s].vertex_count();
  }
}

}  // namespace fascia
