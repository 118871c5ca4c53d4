#include "assembly/actions/actions.hpp"
#include "assembly/simulation/mechanisms.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace fascia {

namespace {

const char* const kRemedy = "add a constraint, or use kind = \"implicit-euler\"";

std::string around(const Piece& piece) {
  return fmt::format("around ({:.4g}, {:.4g}, {:.4g})", piece.center[0], piece.center[1], piece.center[2]);
}

/// @param others  further parts of the body that nothing holds
Diagnostic free_piece(const Simulation& s, const Piece& piece, const std::vector<std::string>& motions, int others) {
  const SimulatedBody& b = s.bodies[at(piece.body)];
  const std::string what =
      piece.whole ? "this body"
                  : fmt::format("its part of {} {}s {}{}", piece.nodes.size(), b.node_word(), around(piece),
                                others > 0 ? fmt::format(", and {} more of its parts,", others) : "");
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

/// One for each body that moves; of many motions the first.
void add_mechanisms(const Simulation& s, const Mechanisms& m, const LooseMotions& loose,
                    std::vector<Diagnostic>& errors) {
  constexpr std::size_t kNamed = 6;
  std::map<int, std::vector<std::string>> motions;
  for (const LooseMotion& l : loose.motions) {
    const Piece& piece = m.pieces[at(l.piece)];
    motions[piece.body].push_back(piece.whole ? l.name : fmt::format("{} of its part {}", l.name, around(piece)));
  }
  std::size_t unnamed = at(loose.count) - loose.motions.size();
  for (auto& [body, names] : motions) {
    const std::size_t more = unnamed + (names.size() > kNamed ? names.size() - kNamed : 0);
    unnamed = 0;
    names.resize(std::min(names.size(), kNamed));
    errors.push_back(
        {s.scene.bodies[at(body)].place,
         fmt::format("hangs on a mechanism, which no static solve can hold ({}{}); couple it at more nodes, hold it "
                     "by a constraint, or use kind = \"implicit-euler\"",
                     fmt::join(names, ", "), more > 0 ? fmt::format(", and {} more motions", more) : "")});
  }
}

}  // namespace

void check_support(const Simulation& s) {
  const Mechanisms m = find_mechanisms(s);
  std::vector<Diagnostic> errors;
  std::map<int, int> lone;  // free pieces that nothing is coupled to, of each body
  for (const Assembly& a : m.assemblies)
    if (!a.free.empty() && a.pieces.size() == 1) ++lone[m.pieces[at(a.pieces[0])].body];
  for (const Assembly& a : m.assemblies) {
    const Piece& first = m.pieces[at(a.pieces[0])];
    if (!a.free.empty() && a.pieces.size() > 1) errors.push_back(free_bodies(s, m, a));
    if (int& count = lone[first.body]; !a.free.empty() && a.pieces.size() == 1 && count > 0) {
      errors.push_back(free_piece(s, first, a.free, count - 1));
      count = 0;
    }
    add_mechanisms(s, m, a.loose, errors);
  }
  if (!errors.empty()) throw SceneError(std::move(errors));
}

}  // namespace fascia
