#include "app/mechanisms.hpp"

#include "core/geometry/bounds.hpp"
#include "core/math/index.hpp"
#include "core/model/disjoint_sets.hpp"

#include <fmt/format.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia::app {

namespace {

using Motion6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Dense = Eigen::MatrixXd;

constexpr double kFree = 1e-9;  ///< resistance of a motion of size 1 that counts as none

std::string named_motion(const Motion6& m) {
  const Vec3d v{{m[0], m[1], m[2]}}, w{{m[3], m[4], m[5]}};
  const bool turns = norm(w) > 0.1 * norm(v) || norm(v) < 1e-9;
  const Vec3d d = normalized(turns ? w : v);
  const char* names[3] = {"x", "y", "z"};
  for (int a = 0; a < 3; ++a)
    if (std::abs(d[a]) > 0.999) return fmt::format("{} {}", turns ? "rotation about" : "translation along", names[a]);
  return fmt::format("{} ({:.2f}, {:.2f}, {:.2f})", turns ? "rotation about" : "translation along", d[0], d[1], d[2]);
}

/// The motions without resistance: those along and about the axes first, then what is left of the null space.
std::vector<std::string> free_motions(const Matrix6& resistance) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(resistance);
  std::vector<Motion6> found;
  int dimension = 0;
  for (int k = 0; k < 6; ++k) {
    Motion6 axis = Motion6::Zero();
    axis[k] = 1;
    if (axis.dot(resistance * axis) < kFree) found.push_back(axis);
    if (eigen.eigenvalues()[k] < kFree) ++dimension;
  }
  for (int k = 0; k < dimension && static_cast<int>(found.size()) < dimension; ++k) {
    Motion6 rest = eigen.eigenvectors().col(k);
    for (const Motion6& f : found) rest -= f * f.dot(rest);
    if (rest.norm() > 1e-6) found.push_back(rest.normalized());
  }
  std::vector<std::string> names;
  names.reserve(found.size());
  for (const Motion6& f : found) names.push_back(named_motion(f));
  return names;
}

std::string joined(const std::vector<std::string>& names) {
  return names.size() == 6 ? "every direction" : fmt::format("{}", fmt::join(names, ", "));
}

/// A direction in which something resists the motion of a piece against another one, or against the ground (−1).
struct Tie {
  int piece = -1, other = -1;
  Vec3d X{}, direction{};
  bool rotation = false;
};

/// A piece that a node belongs to. `turns`: the piece drives the node's rotation.
struct Member {
  int piece = 0;
  bool turns = false;
};

class Finder {
 public:
  explicit Finder(const Simulation& s) : s_(s), members_(at(s.model.node_count())) {
    for (std::size_t b = 0; b < s.bodies.size(); ++b) find_pieces(static_cast<int>(b));
    for (std::size_t node = 0; node < members_.size(); ++node) join_members(node);
    add_constraints();
    add_tethers();
    add_springs();
    add_dependents();
  }

  Mechanisms result() {
    Mechanisms m;
    DisjointSets sets(static_cast<int>(pieces_.size()));
    for (const Tie& t : ties_)
      if (t.other >= 0) sets.join(t.piece, t.other);
    std::map<int, std::vector<int>> clusters;
    for (int p = 0; p < static_cast<int>(pieces_.size()); ++p) clusters[sets.root(p)].push_back(p);
    std::map<int, std::vector<const Tie*>> ties;
    for (const Tie& t : ties_) ties[sets.root(t.piece)].push_back(&t);
    for (const auto& [root, members] : clusters) m.assemblies.push_back(assembly(members, ties[root]));
    std::vector<std::vector<const Tie*>> grounded(pieces_.size());
    for (const Tie& t : ties_)
      if (t.other < 0) grounded[at(t.piece)].push_back(&t);
    for (std::size_t p = 0; p < pieces_.size(); ++p)
      m.own_motions.push_back(joined(free_motions(ground_resistance(grounded[p], pieces_[p].center, size_of(p)))));
    m.pieces = std::move(pieces_);
    return m;
  }

 private:
  double size_of(std::size_t piece) const { return s_.bodies[at(pieces_[piece].body)].body->size(); }

  /// Parts of a body that its points and elements tie together. A surface that rides on others is none.
  void find_pieces(int index) {
    const SimulatedBody& b = s_.bodies[at(index)];
    if (s_.scene.bodies[at(index)].model == BodyModel::surface) return;
    const PointSet& set = s_.model.points;
    DisjointSets sets(static_cast<int>(b.nodes.size()));
    std::vector<char> turns(b.nodes.size(), b.vertices ? 0 : 1);
    const auto join = [&](const auto& nodes) {
      for (const int node : nodes)
        sets.join(static_cast<int>(b.index_of(nodes[0])), static_cast<int>(b.index_of(node)));
    };
    for (int g = b.body->first_group; g < b.body->first_group + b.body->group_count; ++g) join(set.nodes(g));
    for (int k = b.body->first_block; k < b.body->first_block + b.body->block_count; ++k)
      set.blocks[at(k)].for_each_element(join);
    for (int k = b.body->first_shell; k < b.body->first_shell + b.body->shell_count; ++k)
      for (int e = 0; e < set.shells[at(k)].count; ++e) join(set.shells[at(k)].element(e));
    std::map<int, int> piece_of_root;
    for (std::size_t i = 0; i < b.nodes.size(); ++i) {
      const int root = sets.root(static_cast<int>(i));
      const auto [place, fresh] = piece_of_root.try_emplace(root, static_cast<int>(pieces_.size()));
      if (fresh) pieces_.push_back({index, {}, {}, false});
      Piece& piece = pieces_[at(place->second)];
      piece.nodes.push_back(b.node_ids[i]);
      piece.center += b.nodes[i];
      const bool drives = turns[i] != 0 && s_.model.kind(b.node_ids[i]) != FrameKind::vertex;
      members_[at(b.node_ids[i])].push_back({place->second, drives});
    }
    for (const auto& [root, p] : piece_of_root) {
      Piece& piece = pieces_[at(p)];
      piece.center *= 1.0 / static_cast<double>(piece.nodes.size());
      piece.whole = piece_of_root.size() == 1;
      std::sort(piece.nodes.begin(), piece.nodes.end());
    }
  }

  void add(int piece, int other, const Vec3d& X, const Vec3d& direction, bool rotation) {
    ties_.push_back({piece, other, X, direction, rotation});
  }

  void add_all(int piece, int other, const Vec3d& X, bool rotation) {
    for (int k = 0; k < 3; ++k) {
      Vec3d e;
      e[k] = 1;
      add(piece, other, X, e, rotation);
    }
  }

  int turning_member(int node) const {
    for (const Member& m : members_[at(node)])
      if (m.turns) return m.piece;
    return -1;
  }

  /// Pieces that have a node in common move with it, and turn with it where they drive its rotation.
  void join_members(std::size_t node) {
    const std::vector<Member>& members = members_[node];
    if (members.size() < 2) return;
    const Vec3d& X = s_.model.rest_position[node];
    const int turning = turning_member(static_cast<int>(node));
    for (std::size_t k = 1; k < members.size(); ++k) add_all(members[k].piece, members[0].piece, X, false);
    for (const Member& m : members)
      if (m.turns && m.piece != turning) add_all(m.piece, turning, X, true);
  }

  void add_constraints() {
    for (const FrameConstraint& c : s_.model.constraints) {
      if (members_[at(c.node)].empty()) continue;
      const Vec3d& X = s_.model.rest_position[at(c.node)];
      for (int k = 0; k < c.translations; ++k)
        add(members_[at(c.node)][0].piece, -1, X, c.translation_axes.row(k), false);
      const int turning = turning_member(c.node);
      for (int k = 0; k < c.rotations && turning >= 0; ++k) add(turning, -1, X, c.rotation_axes.row(k), true);
    }
  }

  int piece_in(int node, int body) const {
    for (const Member& m : members_[at(node)])
      if (pieces_[at(m.piece)].body == body) return m.piece;
    return members_[at(node)].empty() ? -1 : members_[at(node)][0].piece;
  }

  void add_tethers() {
    for (const TetheredMaterial& t : s_.tethered) {
      const Tether& tether = s_.model.tethers[at(t.tether)];
      const int piece = piece_in(t.field.nodes[0], t.body);
      for (const Vec3d& axis : t.axes) add(piece, -1, tether.X, axis, squared_norm(tether.arm) > 0);
    }
  }

  void add_springs() {
    for (const Spring& spring : s_.model.points.springs) {
      if (members_[at(spring.node)].empty()) continue;
      const int piece = members_[at(spring.node)][0].piece;
      const Vec3d along = squared_norm(spring.direction) > 0 ? spring.direction : spring.X - spring.point;
      if (squared_norm(along) > 0)
        add(piece, -1, spring.X, normalized(along), false);
      else
        add_all(piece, -1, spring.X, false);
    }
  }

  void add_dependents() {
    for (const DependentNode& d : s_.model.points.dependents) {
      if (members_[at(d.node)].empty()) continue;
      int host = -1;
      for (const int h : d.hosts)
        if (!members_[at(h)].empty()) host = members_[at(h)][0].piece;
      const int piece = members_[at(d.node)][0].piece;
      if (host < 0 || host == piece) continue;
      const Vec3d& X = s_.model.rest_position[at(d.node)];
      add_all(piece, host, X, false);
      const int turning = turning_member(d.node), turning_host = turning_member(d.hosts[0]);
      if (d.turns && turning >= 0 && turning_host >= 0) add_all(turning, turning_host, X, true);
    }
  }

  /// Against motions of everything as one rigid body.
  static Matrix6 ground_resistance(const std::vector<const Tie*>& ties, const Vec3d& center, double size) {
    Matrix6 resistance = Matrix6::Zero();
    for (const Tie* t : ties) {
      if (t->other >= 0) continue;
      const Motion6 row = row_of(*t, center, size);
      resistance += row * row.transpose();
    }
    return resistance;
  }

  static Motion6 row_of(const Tie& t, const Vec3d& center, double size) {
    const Vec3d d = t.direction, moment = t.rotation ? d : cross((t.X - center) * (1 / size), d);
    const Vec3d force = t.rotation ? Vec3d{} : d;
    return Motion6{{force[0], force[1], force[2], moment[0], moment[1], moment[2]}};
  }

  Assembly assembly(const std::vector<int>& members, const std::vector<const Tie*>& ties) const {
    Assembly a;
    a.pieces = members;
    Bounds bounds;
    Vec3d center;
    double size = 0;
    for (const int p : members) {
      center += pieces_[at(p)].center * (1.0 / static_cast<double>(members.size()));
      size = std::max(size, size_of(at(p)));
    }
    if (members.size() == 1) center = pieces_[at(members[0])].center;
    a.free = free_motions(ground_resistance(ties, center, size));
    if (members.size() > 1) find_loose(members, ties, center, size, static_cast<int>(a.free.size()), a);
    return a;
  }

  /// Motions of the pieces against one another that nothing resists.
  void find_loose(const std::vector<int>& members, const std::vector<const Tie*>& ties, const Vec3d& center,
                  double size, int rigid, Assembly& a) const {
    const auto n = static_cast<Eigen::Index>(6 * members.size());
    std::map<int, Eigen::Index> place;
    for (const int p : members) place.emplace(p, 6 * static_cast<Eigen::Index>(place.size()));
    Dense K = Dense::Zero(n, n);
    for (const Tie* t : ties) {
      const Motion6 row = row_of(*t, center, size);
      const Matrix6 block = row * row.transpose();
      const Eigen::Index i = place[t->piece];
      K.block<6, 6>(i, i) += block;
      if (t->other < 0) continue;
      const Eigen::Index j = place[t->other];
      K.block<6, 6>(j, j) += block;
      K.block<6, 6>(i, j) -= block;
      K.block<6, 6>(j, i) -= block;
    }
    const Eigen::SelfAdjointEigenSolver<Dense> eigen(K);
    int dimension = 0;
    while (dimension < n && eigen.eigenvalues()[dimension] < kFree) ++dimension;
    if (dimension <= rigid) return;
    // What is left of the null space beside the motions of everything together: each motion against the mean.
    Dense null = eigen.eigenvectors().leftCols(dimension);
    Dense mean = Dense::Zero(6, dimension);
    for (Eigen::Index p = 0; p < n; p += 6) mean += null.middleRows<6>(p) * (6.0 / static_cast<double>(n));
    for (Eigen::Index p = 0; p < n && rigid > 0; p += 6) null.middleRows<6>(p) -= mean;
    const Eigen::JacobiSVD<Dense> svd(null, Eigen::ComputeThinU);
    for (Eigen::Index k = 0; k < dimension - rigid; ++k) {
      const Eigen::VectorXd motion = svd.matrixU().col(k);
      Eigen::Index most = 0;
      double largest = 0;
      for (Eigen::Index p = 0; p < n; p += 6) {
        const double amount = moved(members[at(static_cast<int>(p / 6))], motion.segment<6>(p), center, size);
        if (amount <= largest * (1 + 1e-9)) continue;
        largest = amount;
        most = p;
      }
      const Piece& piece = pieces_[at(members[at(static_cast<int>(most / 6))])];
      Motion6 about = motion.segment<6>(most);
      const Vec3d w{{about[3], about[4], about[5]}}, v = cross(w, (piece.center - center) * (1 / size));
      for (int c = 0; c < 3; ++c) about[c] += v[c];
      a.loose.push_back(fmt::format("\"{}\": {}", s_.bodies[at(piece.body)].name, named_motion(about)));
    }
  }

  /// Displacement and rotation of a piece's centre.
  double moved(int piece, const Motion6& m, const Vec3d& center, double size) const {
    const Vec3d w{{m[3], m[4], m[5]}}, arm = (pieces_[at(piece)].center - center) * (1 / size);
    return norm(Vec3d{{m[0], m[1], m[2]}} + cross(w, arm)) + norm(w);
  }

  const Simulation& s_;
  std::vector<Piece> pieces_;
  std::vector<std::vector<Member>> members_;  ///< of each node
  std::vector<Tie> ties_;
};

}  // namespace

Mechanisms find_mechanisms(const Simulation& simulation) { return Finder(simulation).result(); }

}  // namespace fascia::app
