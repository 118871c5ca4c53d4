#include "core/cpu/surface_tangent.hpp"

#include "core/math/index.hpp"
#include "core/math/rotation.hpp"
#include "core/model/model.hpp"

#include <algorithm>
#include <array>

namespace fascia {

namespace {

using FaceBlocks = std::array<std::array<Mat3d, kMostFaceNodes>, kMostFaceNodes>;

/// The terms with p are antisymmetric matrices, and antisymmetric in i and j.
void face_blocks(const SurfaceTangent& tangent, std::span<const int> face, FaceBlocks& K) {
  const std::size_t n = face.size();
  const Vec3d& g = tangent.gradient;
  const bool weighs = squared_norm(g) > 0;
  std::array<std::array<Vec3d, kMostFaceNodes>, kMostFaceNodes> axis;  // of K_ij, j < i
  for (std::size_t i = 0; i < n; ++i) {
    std::fill_n(axis[i].begin(), n, Vec3d{});
    std::fill_n(K[i].begin(), n, Mat3d{});
  }
  for (const FaceRulePoint& q : face_rule(static_cast<int>(n))) {
    Vec3d x, xs, xt;
    for (std::size_t a = 0; a < n; ++a) {
      const Vec3d& v = tangent.x[at(face[a])];
      x += v * q.N[a];
      xs += v * q.ds[a];
      xt += v * q.dt[a];
    }
    const double half = -0.5 * q.weight, p = half * (tangent.pressure + dot(g, x));
    const Vec3d ps = xs * p, pt = xt * p;
    for (std::size_t i = 1; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j)
        axis[i][j] += ps * (q.N[i] * q.dt[j] - q.N[j] * q.dt[i]) - pt * (q.N[i] * q.ds[j] - q.N[j] * q.ds[i]);
    if (!weighs) continue;
    const Vec3d normal = cross(xs, xt);
    const Mat3d slope = (outer(normal, g) + outer(g, normal)) * half;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) K[i][j] += slope * (q.N[i] * q.N[j]);
  }
  for (std::size_t i = 1; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Mat3d turn = skew(axis[i][j]);
      K[i][j] += turn;
      K[j][i] -= turn;
    }
}

/// How the degrees of freedom of a node move a vertex: column by column.
using Columns = std::array<Vec3d, kMostDofs>;

Columns columns_of(const SurfaceShare& share, FrameKind kind, const Mat3d& Q) {
  Columns J{};
  for (int k = 0; k < 3; ++k) J[at(k)][k] = share.w;
  for (int k = 0; k < dof_count(kind) - 3; ++k) {
    double unit[kMostDofs - 3] = {};
    unit[k] = 1;
    J[at(3 + k)] = frame_variation(kind, unit, Q) * share.b;
  }
  return J;
}

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
      double* g = out.data() + dofs.begin(share.node);
      for (int k = 0; k < 3; ++k) g[k] += share.w * f[k];
      if (dofs.kind(share.node) == FrameKind::vertex) continue;
      add_moment(dofs.kind(share.node), outer(f, share.b), Mat3d::identity() + state.D[at(share.node)], g + 3);
    }
  }
}

void add_product(const SurfaceTangent& tangent, const DofLayout& dofs, const std::vector<Mat3d>& Q,
                 std::span<const double> x, std::span<double> y) {
  const SurfaceLoad& load = *tangent.load;
  std::vector<Vec3d> dx(load.X.size()), force(load.X.size());
  for (int v = 0; v < load.vertex_count(); ++v)
    for (const SurfaceShare& share : load.shares_of(v)) {
      const double* d = x.data() + dofs.begin(share.node);
      dx[at(v)] += Vec3d{{d[0], d[1], d[2]}} * share.w +
                   frame_variation(dofs.kind(share.node), d + 3, Q[at(share.node)]) * share.b;
    }
  FaceBlocks K;
  for (int f = 0; f < load.face_count(); ++f) {
    const std::span<const int> face = load.face(f);
    face_blocks(tangent, face, K);
    for (std::size_t i = 0; i < face.size(); ++i)
      for (std::size_t j = 0; j < face.size(); ++j) force[at(face[i])] += K[i][j] * dx[at(face[j])];
  }
  for (int v = 0; v < load.vertex_count(); ++v)
    for (const SurfaceShare& share : load.shares_of(v)) {
      double* out = y.data() + dofs.begin(share.node);
      for (int k = 0; k < 3; ++k) out[k] += share.w * force[at(v)][k];
      add_moment(dofs.kind(share.node), outer(force[at(v)], share.b), Q[at(share.node)], out + 3);
    }
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
  std::vector<int> nodes;                    // of a face
  std::vector<Columns> J;                    // (nodes × vertices of the face)
  std::vector<char> moves;                   // likewise: J is not zero
  std::array<Columns, kMostFaceNodes> pull;  // Σ K_ij J_j of one node, by vertices
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
        J[k * n + i] = columns_of(share, dofs.kind(share.node), Q[at(share.node)]);
        moves[k * n + i] = 1;
      }
    face_blocks(tangent, face, K);
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
