#include "app/explain/body_motion.hpp"

#include "core/math/dense.hpp"
#include "core/math/mat3.hpp"
#include "io/result_reader.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

Vec3d vector_at(const std::vector<double>& numbers, std::size_t i) {
  return {{numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]}};
}

/// Quaternion (w, x, y, z) of the rotation that takes points about their mean closest to others, in the sense of least
/// squares: the eigenvector of the largest eigenvalue of Horn's matrix (J. Opt. Soc. Am. A 4, 1987, section 4). Where
/// points on a line leave some of it open, the smallest such rotation.
Eigen::Vector4d best_rotation(const Mat3d& S) {
  Eigen::Matrix4d N;
  N << S(0, 0) + S(1, 1) + S(2, 2), S(1, 2) - S(2, 1), S(2, 0) - S(0, 2), S(0, 1) - S(1, 0),  //
      S(1, 2) - S(2, 1), S(0, 0) - S(1, 1) - S(2, 2), S(0, 1) + S(1, 0), S(2, 0) + S(0, 2),   //
      S(2, 0) - S(0, 2), S(0, 1) + S(1, 0), S(1, 1) - S(0, 0) - S(2, 2), S(1, 2) + S(2, 1),   //
      S(0, 1) - S(1, 0), S(2, 0) + S(0, 2), S(1, 2) + S(2, 1), S(2, 2) - S(0, 0) - S(1, 1);
  const Eigenpairs eigen = symmetric_eigen(N);
  const double largest = eigen.values[3];
  Eigen::Vector4d q = Eigen::Vector4d::Zero();
  for (int k = 0; k < 4; ++k)
    if (eigen.values[k] >= largest - 1e-9 * std::abs(largest)) q += eigen.vectors.col(k) * eigen.vectors(0, k);
  return q.norm() > 0 ? Eigen::Vector4d(q.normalized()) : Eigen::Vector4d(eigen.vectors.col(3));
}

Mat3d matrix_of(const Eigen::Vector4d& q) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return transpose(Mat3d::from_columns({{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)}},
                                       {{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)}},
                                       {{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}));
}

void add_motion(const std::vector<double>& rest, const std::vector<double>& now, BodyMotion& motion) {
  const std::size_t count = rest.size() / 3;
  if (count == 0 || now.size() != rest.size()) return;
  Vec3d rest_mean{}, mean{};
  for (std::size_t i = 0; i < count; ++i) {
    rest_mean += vector_at(rest, i) * (1.0 / static_cast<double>(count));
    mean += vector_at(now, i) * (1.0 / static_cast<double>(count));
  }
  Mat3d S;  // Σ X xᵀ
  for (std::size_t i = 0; i < count; ++i) S += outer(vector_at(rest, i) - rest_mean, vector_at(now, i) - mean);
  const Eigen::Vector4d q = best_rotation(S);
  motion.rotation = std::max(motion.rotation, 2 * std::atan2(q.tail<3>().norm(), std::abs(q[0])));
  const Mat3d R = matrix_of(q);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d X = vector_at(rest, i), x = vector_at(now, i);
    motion.displacement = std::max(motion.displacement, norm(x - X));
    motion.deformation = std::max(motion.deformation, norm(x - mean - R * (X - rest_mean)));
  }
}

/// The largest magnitude of a principal value of symmetric matrices, by rows, where it is above `least`.
double largest_principal(const std::vector<double>& matrices, double least) {
  for (std::size_t i = 0; i + 9 <= matrices.size(); i += 9) {
    const Eigen::Map<const Eigen::Matrix3d> E(matrices.data() + i);
    if (!(E.norm() > least) || !std::isfinite(E.norm())) continue;  // the norm is no less than any principal value
    least = std::max(least, symmetric_eigen(E).values.cwiseAbs().maxCoeff());
  }
  return least;
}

}  // namespace

std::map<std::string, BodyMotion> body_motions(const std::filesystem::path& pvd) {
  std::map<std::string, BodyMotion> motions;
  for (const io::CollectionEntry& entry : io::read_collection(pvd)) {
    const io::ResultArrays arrays = io::read_result_arrays(pvd.parent_path() / entry.file);
    BodyMotion& motion = motions[entry.body];
    const auto rest = arrays.find("rest_position"), now = arrays.find("points"), strain = arrays.find("strain");
    if (rest != arrays.end() && now != arrays.end()) add_motion(rest->second, now->second, motion);
    if (strain != arrays.end()) motion.strain = largest_principal(strain->second, motion.strain.value_or(0));
  }
  return motions;
}

}  // namespace fascia::app
