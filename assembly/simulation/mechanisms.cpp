#include "assembly/simulation/mechanisms.hpp"

#include "core/base/disjoint_sets.hpp"
#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace fascia {

namespace {

std::string joined(const std::vector<std::string>& motions) {
  return motions.size() == 6 ? "every direction" : fmt::format("{}", fmt::join(motions, ", "));
}

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
    for (const DependentNode& d : s.model.points.dependents) follows_.emplace(d.node, &d);
    add_constraints();
    add_tethers();
    add_springs();
    add_dependents();
  }

  Mechanisms result() {
    Mechanisms m;
    for (const Piece& p : pieces_) rigid_.push_back({p.center, s_.bodies[at(p.body)].body->size()});
    DisjointSets sets(static_cast<int>(pieces_.size()));
    for (const Tie& t : ties_)
      if (t.other >= 0) sets.join(t.piece, t.other);
    std::map<int, std::vector<int>> clusters;
    for (int p = 0; p < static_cast<int>(pieces_.size()); ++p) clusters[sets.root(p)].push_back(p);
    std::map<int, std::vector<const Tie*>> ties;
    for (const Tie& t : ties_) ties[sets.root(t.piece)].push_back(&t);
    for (const auto& [root, members] : clusters) m.assemblies.push_back(assembly(members, ties[root]));
    std::vector<std::vector<const Tie*>> own(pieces_.size());
    for (const Tie& t : ties_)
      if (t.other < 0) own[at(t.piece)].push_back(&t);
    for (std::size_t p = 0; p < pieces_.size(); ++p) m.own_motions.push_back(joined(free_motions(own[p], rigid_[p])));
    m.pieces = std::move(pieces_);
    return m;
  }

 private:
  /// Parts of a body that its points and elements tie together. A surface that rides on others is none.
  void find_pieces(int index) {
    const SimulatedBody& b = s_.bodies[at(index)];
    if (s_.scene.bodies[at(index)].model == BodyModel::surface) return;
    DisjointSets sets(static_cast<int>(b.nodes.size()));
    std::vector<char> turns(b.nodes.size(), b.vertices ? 0 : 1);
    const auto join = [&](const auto& nodes) {
      for (const int node : nodes)
        sets.join(static_cast<int>(b.index_of(nodes[0])), static_cast<int>(b.index_of(node)));
    };
    s_.model.points.for_each_joined(b.body->blocks, join);
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

  /// The piece that a node belongs to, or that it rides on through a surface without matter; −1: none.
  int carrier(int node) const {
    if (!members_[at(node)].empty()) return members_[at(node)][0].piece;
    const auto follows = follows_.find(node);
    int piece = -1;
    if (follows != follows_.end())
      for (const int host : follows->second->hosts) piece = std::max(piece, carrier(host));
    return piece;
  }

  void add_springs() {
    for (const Spring& spring : s_.model.points.springs) {
      const int piece = carrier(spring.node);
      if (piece < 0) continue;
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
      for (const int h : d.hosts) host = std::max(host, carrier(h));
      const int piece = members_[at(d.node)][0].piece;
      if (host < 0 || host == piece) continue;
      const Vec3d& X = s_.model.rest_position[at(d.node)];
      add_all(piece, host, X, false);
      const int turning = turning_member(d.node), turning_host = turning_member(d.hosts[0]);
      if (d.turns && turning >= 0 && turning_host >= 0) add_all(turning, turning_host, X, true);
    }
  }

  Assembly assembly(const std::vector<int>& members, const std::vector<const Tie*>& ties) const {
    Assembly a;
    a.pieces = members;
    a.free = free_motions(ties, whole_of(rigid_, members));
    if (members.size() > 1) a.loose = loose_motions(rigid_, members, ties);
    return a;
  }

  const Simulation& s_;
  std::vector<Piece> pieces_;
  std::vector<RigidPiece> rigid_;             ///< the same
  std::vector<std::vector<Member>> members_;  ///< of each node
  std::map<int, const DependentNode*> follows_;
  std::vector<Tie> ties_;
};

}  // namespace

Mechanisms find_mechanisms(const Simulation& simulation) { return Finder(simulation).result(); }

int free_motion_count(const Mechanisms& mechanisms) {
  int count = 0;
  for (const Assembly& a : mechanisms.assemblies) count += static_cast<int>(a.free.size()) + a.loose.count;
  return count;
}

}  // namespace fascia
