#include "assembly/simulation/loose_motions.hpp"

#include "core/base/disjoint_sets.hpp"
#include "core/base/index.hpp"
#include "core/math/dense.hpp"
#include "core/math/mat3.hpp"

#include <fmt/format.h>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia {

namespace {

/// Velocity of the centre and spin times size.
using Motion6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Dense = Eigen::MatrixXd;
using Sparse = Eigen::SparseMatrix<double>;

constexpr double kFree = 1e-9;    ///< resistance of a motion of size 1 that counts as none
constexpr double kJoined = 1e-4;  ///< least resistance between two pieces that move as one
constexpr double kZero = 1e-6;    ///< part of a motion that counts as none
constexpr Eigen::Index kDense = 600, kSample = 16;

std::string named_motion(const Motion6& m) {
  const Vec3d v{{m[0], m[1], m[2]}}, w{{m[3], m[4], m[5]}};
  const bool turns = norm(w) > 0.1 * norm(v) || norm(v) < 1e-9;
  const Vec3d d = normalized(turns ? w : v);
  const char* names[3] = {"x", "y", "z"};
  for (int a = 0; a < 3; ++a)
    if (std::abs(d[a]) > 0.999) return fmt::format("{} {}", turns ? "rotation about" : "translation along", names[a]);
  return fmt::format("{} ({:.2f}, {:.2f}, {:.2f})", turns ? "rotation about" : "translation along", d[0], d[1], d[2]);
}

/// What a tie sees of a piece's motion. @param unit  of its rotation [m]
Motion6 row_of(const Tie& t, const RigidPiece& piece, double unit) {
  const Vec3d d = t.direction;
  const Vec3d moment = t.rotation ? d * (unit / piece.size) : cross((t.X - piece.center) * (1 / piece.size), d);
  const Vec3d force = t.rotation ? Vec3d{} : d;
  return Motion6{{force[0], force[1], force[2], moment[0], moment[1], moment[2]}};
}

/// Combines the columns from `first` on so that each has a component of a piece's motion to itself: spins about the
/// axes where they can, then velocities along them. Those without a part in it stay behind.
/// @return the first column behind those that move the piece
Eigen::Index untangle(Dense& motions, Eigen::Index piece, Eigen::Index first) {
  const Eigen::Index begin = first, count = motions.cols();
  const double scale = motions.block(6 * piece, first, 6, count - first).norm();
  for (const Eigen::Index component : {3, 4, 5, 0, 1, 2}) {
    if (first == count) break;
    const Eigen::Index row = 6 * piece + component;
    Eigen::Index most = first;
    for (Eigen::Index k = first; k < count; ++k)
      if (std::abs(motions(row, k)) > std::abs(motions(row, most))) most = k;
    if (std::abs(motions(row, most)) < kZero * scale) continue;
    motions.col(first).swap(motions.col(most));
    motions.col(first) /= motions(row, first);
    for (Eigen::Index k = begin; k < count; ++k)
      if (k != first) motions.col(k) -= double(motions(row, k)) * motions.col(first);
    ++first;
  }
  return first;
}

/// Null space of the resistance of one body against the ground.
Dense null_space_of_one(const std::vector<const Tie*>& ties, const RigidPiece& body) {
  Matrix6 resistance = Matrix6::Zero();
  for (const Tie* t : ties) {
    if (t->other >= 0) continue;
    const Motion6 row = row_of(*t, body, body.size);
    resistance += row * row.transpose();
  }
  const Eigenpairs eigen = symmetric_eigen(resistance);
  Eigen::Index dimension = 0;
  while (dimension < 6 && eigen.values[dimension] < kFree) ++dimension;
  return eigen.vectors.leftCols(dimension);
}

struct NullSpace {
  Dense basis;  ///< of many motions a sample
  Eigen::Index dimension = 0;
};

NullSpace null_space(const Sparse& K) {
  const Eigen::Index n = K.rows();
  NullSpace null;
  if (n <= kDense) {
    const Eigenpairs eigen = symmetric_eigen(Dense(K));
    while (null.dimension < n && eigen.values[null.dimension] < kFree) ++null.dimension;
    null.basis = eigen.vectors.leftCols(null.dimension);
    return null;
  }
  Sparse unit(n, n);
  unit.setIdentity();
  // By Sylvester's law as many pivots are negative as eigenvalues lie below the shift.
  const Eigen::SimplicialLDLT<Sparse> below(K - kFree * unit), above(K + kFree * unit);
  null.dimension = (below.vectorD().array() < 0).count();
  const Eigen::Index count = std::min(null.dimension, kSample);
  null.basis = Dense::Zero(n, count);
  for (Eigen::Index k = 0; k < count; ++k)
    for (Eigen::Index i = 0; i < n; ++i) null.basis(i, k) = std::cos(1.0 + static_cast<double>(i * (2 * k + 1)));
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds && count > 0; ++round) {
    const Dense next = above.solve(null.basis);
    null.basis = orthonormal(next);
  }
  return null;
}

/// Pieces that hang together, joined where nothing moves them against one another or against the ground.
class Clusters {
 public:
  Clusters(const std::vector<RigidPiece>& pieces, const std::vector<int>& members, const std::vector<const Tie*>& ties)
      : ties_(ties) {
    for (const int p : members) place_.emplace(p, static_cast<int>(place_.size()) + 1);
    DisjointSets sets(static_cast<int>(place_.size()) + 1);  // 0: the ground
    while (join(pieces, members, sets)) {
    }
    cluster_.assign(place_.size() + 1, -1);
    for (const int p : members) {
      const int root = sets.root(place_.at(p));
      if (root == 0) continue;
      if (cluster_[at(root)] < 0) {
        cluster_[at(root)] = static_cast<int>(first_.size());
        first_.push_back(p);
        bodies_.push_back(pieces[at(p)]);
      }
      RigidPiece& body = bodies_[at(cluster_[at(root)])];
      body.size = std::max(body.size, pieces[at(p)].size);
      cluster_[at(place_.at(p))] = cluster_[at(root)];
    }
  }

  Eigen::Index count() const { return static_cast<Eigen::Index>(first_.size()); }
  const RigidPiece& body(Eigen::Index k) const { return bodies_[static_cast<std::size_t>(k)]; }
  /// Its first piece.
  int piece(Eigen::Index k) const { return first_[static_cast<std::size_t>(k)]; }

  /// Against motions of the clusters.
  Sparse resistance() const {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int a, int b, const Matrix6& block) {
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j)
          if (block(i, j) != 0) entries.emplace_back(6 * a + i, 6 * b + j, block(i, j));
    };
    for (const Tie* t : ties_) {
      const int a = cluster_of(t->piece), b = cluster_of(t->other);
      if (a == b) continue;
      const double unit = a < 0   ? bodies_[at(b)].size
                          : b < 0 ? bodies_[at(a)].size
                                  : std::min(bodies_[at(a)].size, bodies_[at(b)].size);
      const Motion6 row_a = a < 0 ? Motion6::Zero() : row_of(*t, bodies_[at(a)], unit),
                    row_b = b < 0 ? Motion6::Zero() : row_of(*t, bodies_[at(b)], unit);
      if (a >= 0) add(a, a, row_a * row_a.transpose());
      if (b >= 0) add(b, b, row_b * row_b.transpose());
      if (a < 0 || b < 0) continue;
      add(a, b, -row_a * row_b.transpose());
      add(b, a, -row_b * row_a.transpose());
    }
    Sparse K(6 * count(), 6 * count());
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
  }

 private:
  int cluster_of(int piece) const { return piece < 0 ? -1 : cluster_[at(place_.at(piece))]; }

  /// Joins every two that all six motions against each other are resisted of; false where there are none.
  bool join(const std::vector<RigidPiece>& pieces, const std::vector<int>& members, DisjointSets& sets) const {
    std::map<std::pair<int, int>, Matrix6> between;
    for (const Tie* t : ties_) {
      const int a = sets.root(place_.at(t->piece)), b = t->other < 0 ? 0 : sets.root(place_.at(t->other));
      if (a == b) continue;
      const RigidPiece& body = pieces[at(members[at(std::max(a, b) - 1)])];
      const Motion6 row = row_of(*t, body, body.size);
      between.try_emplace(std::minmax(a, b), Matrix6::Zero()).first->second += row * row.transpose();
    }
    bool joined = false;
    for (const auto& [pair, resistance] : between) {
      if (symmetric_eigen(resistance).values[0] < kJoined) continue;
      sets.join(pair.first, pair.second);
      joined = true;
    }
    return joined;
  }

  const std::vector<const Tie*>& ties_;
  std::map<int, int> place_;  ///< of a piece, from 1
  std::vector<int> cluster_;  ///< of each place; −1: held
  std::vector<int> first_;    ///< piece of each cluster
  std::vector<RigidPiece> bodies_;
};

/// The `count` directions in which columns (orthonormal ones, projected) reach farthest, orthonormal, farthest first.
Dense largest_directions(const Dense& columns, Eigen::Index count) {
  const Eigenpairs gram = symmetric_eigen(columns.transpose() * columns);
  Dense directions = columns * gram.vectors.rightCols(count).rowwise().reverse();
  directions.colwise().normalize();
  return directions;
}

/// Takes the motions of everything as one body out of a null space. @return how many are left
Eigen::Index take_out(const Clusters& clusters, const RigidPiece& whole, const Dense& rigid, NullSpace& null) {
  if (rigid.cols() == 0) return null.dimension;
  Dense all(null.basis.rows(), rigid.cols());
  for (Eigen::Index k = 0; k < clusters.count(); ++k)
    for (Eigen::Index m = 0; m < rigid.cols(); ++m) {
      const Vec3d v{{rigid(0, m), rigid(1, m), rigid(2, m)}},
          w = Vec3d{{rigid(3, m), rigid(4, m), rigid(5, m)}} * (1 / whole.size),
          moved = v + cross(w, clusters.body(k).center - whole.center), turned = w * clusters.body(k).size;
      all.block<6, 1>(6 * k, m) << moved[0], moved[1], moved[2], turned[0], turned[1], turned[2];
    }
  all = orthonormal(all);
  null.basis -= all * (all.transpose() * null.basis);
  return std::max<Eigen::Index>(0, null.dimension - rigid.cols());
}

}  // namespace

RigidPiece whole_of(const std::vector<RigidPiece>& pieces, const std::vector<int>& members) {
  RigidPiece whole{{}, 0};
  for (const int p : members) {
    whole.center += pieces[at(p)].center * (1.0 / static_cast<double>(members.size()));
    whole.size = std::max(whole.size, pieces[at(p)].size);
  }
  return whole;
}

std::vector<std::string> free_motions(const std::vector<const Tie*>& ties, const RigidPiece& body) {
  Dense motions = null_space_of_one(ties, body);
  const Eigen::Index count = untangle(motions, 0, 0);
  std::vector<std::string> translations, rotations;
  for (Eigen::Index k = 0; k < count; ++k) {
    std::string name = named_motion(motions.col(k));
    (name.starts_with("rotation") ? rotations : translations).push_back(std::move(name));
  }
  translations.insert(translations.end(), rotations.begin(), rotations.end());
  return translations;
}

LooseMotions loose_motions(const std::vector<RigidPiece>& pieces, const std::vector<int>& members,
                           const std::vector<const Tie*>& ties) {
  const Clusters clusters(pieces, members, ties);
  LooseMotions loose;
  if (clusters.count() == 0) return loose;
  const RigidPiece whole = whole_of(pieces, members);
  NullSpace null = null_space(clusters.resistance());
  const Eigen::Index left = take_out(clusters, whole, null_space_of_one(ties, whole), null);
  loose.count = static_cast<int>(left);
  if (left == 0) return loose;
  Dense motions = largest_directions(null.basis, std::min(left, null.basis.cols()));
  for (Eigen::Index first = 0; first < motions.cols();) {
    Eigen::Index most = 0;
    double largest = 0;
    for (Eigen::Index k = 0; k < clusters.count(); ++k) {
      const double amount = motions.block(6 * k, first, 6, motions.cols() - first).norm();
      if (amount <= largest * (1 + kZero)) continue;
      largest = amount;
      most = k;
    }
    const Eigen::Index next = largest > 0 ? untangle(motions, most, first) : first;
    for (Eigen::Index k = first; k < next; ++k)
      loose.motions.push_back({clusters.piece(most), named_motion(motions.block<6, 1>(6 * most, k))});
    if (next == first) break;
    first = next;
  }
  return loose;
}

}  // namespace fascia
