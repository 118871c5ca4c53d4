#pragma once

#include "tests/support/scene_run.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

/// Scenes that a test writes: bodies of boxes, side by side, and what couples them.
namespace fascia::test {

using Vector = std::array<double, 3>;

/// The text of a scene in a file that goes with this object.
struct SceneText {
  TemporaryFolder folder;
  explicit SceneText(const std::string& text) { std::ofstream(folder.path / "scene.toml") << text; }
  std::string scene() const { return (folder.path / "scene").string(); }
};

/// A run of a scene's text on one thread.
class TextRun : private SceneText, public SceneRun {
 public:
  explicit TextRun(const std::string& text) : SceneText(text), SceneRun(scene(), {}, {"--threads", "1"}) {}

  /// What a body's tissue does on another one: "force" or "moment"; of a coupling without the other one.
  Vector coupling(const std::string& name, const std::string& what, const std::string& on = "") const {
    const nlohmann::json& all = summary()["couplings"];
    if (!all.contains(name) || (!on.empty() && !all[name]["on"].contains(on))) {
      ADD_FAILURE() << "no coupling " << name << ' ' << on;
      return as_vector(nullptr);
    }
    return as_vector(on.empty() ? all[name][what] : all[name]["on"][on][what]);
  }
};

inline Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector operator*(const Vector& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
inline double length(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }
/// |a − b| / |b|.
inline double relative(const Vector& a, const Vector& b) { return length(a - b) / length(b); }

/// "[1,2,3]".
inline std::string list(const Vector& a) { return fmt::format("[{:.17g},{:.17g},{:.17g}]", a[0], a[1], a[2]); }

/// The box between two corners, as a value.
inline std::string box(const Vector& low, const Vector& high) {
  return fmt::format("{{box={{min={},max={}}}}}", list(low), list(high));
}

/// How a box is discretised, with n cells a metre.
enum class Kind { grid, scattered, tetrahedra, hexahedra };

inline const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::grid:
      return "grid";
    case Kind::scattered:
      return "scattered";
    case Kind::tetrahedra:
      return "tetrahedra";
    case Kind::hexahedra:
      return "hexahedra";
  }
  return "";
}

/// @param share  entries of frames.share, of a meshless body
inline std::string box_body(const std::string& name, Kind kind, const Vector& low, const Vector& high, int n,
                            const std::string& share = "", const std::string& more = "density=12") {
  std::array<int, 3> cells{};
  for (std::size_t k = 0; k < 3; ++k) cells[k] = static_cast<int>(std::lround(n * (high[k] - low[k])));
  const std::string corners = fmt::format("min={},max={}", list(low), list(high));
  std::string text = fmt::format("[bodies.{}]\nmaterial=\"soft\"\n{}\n", name, more);
  if (kind == Kind::tetrahedra || kind == Kind::hexahedra)
    return text + fmt::format("model=\"{}\"\ndomain={{box={{{},cells=[{},{},{}]}}}}\n", name_of(kind), corners,
                              cells[0], cells[1], cells[2]);
  const std::string frames = kind == Kind::grid
                                 ? fmt::format("grid=[{},{},{}]", cells[0] + 1, cells[1] + 1, cells[2] + 1)
                                 : fmt::format("poisson_disk={:.17g}", 1.0 / n);
  return text +
         fmt::format("model=\"meshless\"\ndomain={{box={{{}}}}}\nframes={{{},share=[{}]}}\n", corners, frames, share);
}

inline std::string fix(const std::string& body, const std::string& where, const std::string& what = "fix=\"all\"") {
  return fmt::format("[[constraints]]\nbody=\"{}\"\nwhere={}\n{}\n", body, where, what);
}

inline std::string probe_at(const std::string& name, const std::string& body, const Vector& at,
                            const std::string& quantity = "displacement") {
  return fmt::format("[probes.{}]\nbody=\"{}\"\nat={}\nquantity=\"{}\"\n", name, body, list(at), quantity);
}

inline std::string probe_of(const std::string& name, const std::string& body, const std::string& where,
                            const std::string& quantity) {
  return fmt::format("[probes.{}]\nbody=\"{}\"\nwhere={}\nquantity=\"{}\"\n", name, body, where, quantity);
}

inline std::string coupling(const std::string& name, const std::string& kind, const std::string& body,
                            const std::string& where, const std::string& rest) {
  return fmt::format("[couplings.{}]\nkind=\"{}\"\nbody=\"{}\"\nwhere={}\n{}\n", name, kind, body, where, rest);
}

}  // namespace fascia::test
