#include "app/mechanisms.hpp"
#include "app/scene/errors.hpp"
#include "app/simulation.hpp"
#include "core/math/index.hpp"

#include <fmt/format.h>

#include <set>

namespace fascia::app {

namespace {

const char* const kRemedy = "add a constraint, or use kind = \"implicit-euler\"";

Diagnostic free_piece(const Simulation& s, const Piece& piece, const std::vector<std::string>& motions) {
  const SimulatedBody& b = s.bodies[at(piece.body)];
  const std::string what = piece.whole
                               ? "this body"
                               : fmt::format("its part of {} {}s around ({:.4g}, {:.4g}, {:.4g})", piece.nodes.size(),
                                             b.node_word(), piece.center[0], piece.center[1], piece.center[2]);
  return {s.scene.bodies[at(piece.body)].place,
          fmt::format("nothing holds {} in a static solve ({}); {}", what, fmt::join(motions, ", "), kRemedy)};
}

Diagnostic free_bodies(const Simulation& s, const Mechanisms& m, const Assembly& a) {
  const int first = m.pieces[at(a.pieces[0])].body;
  std::set<std::string> others;
  for (const int p : a.pieces)
    if (m.pieces[at(p)].body != first) others.insert("\"" + s.bodies[at(m.pieces[at(p)].body)].name + "\"");
  return {s.scene.bodies[at(first)].place,
          fmt::format("nothing holds this body and what is coupled to it ({}) in a static solve ({}); {}",
                      fmt::join(others, ", "), fmt::join(a.free, ", "), kRemedy)};
}

}  // namespace

void check_support(const Simulation& s) {
  const Mechanisms m = find_mechanisms(s);
  std::vector<Diagnostic> errors;
  for (const Assembly& a : m.assemblies) {
    const Piece& first = m.pieces[at(a.pieces[0])];
    if (!a.free.empty()) errors.push_back(a.pieces.size() == 1 ? free_piece(s, first, a.free) : free_bodies(s, m, a));
    if (!a.loose.empty())
      errors.push_back({s.scene.bodies[at(first.body)].place,
                        fmt::format("is coupled through a mechanism, which no static solve can hold ({}); couple that "
                                    "body at more nodes, hold it by a constraint, or use kind = \"implicit-euler\"",
                                    fmt::join(a.loose, ", "))});
  }
  if (!errors.empty()) throw SceneError(std::move(errors));
}

}  // namespace fascia::app
