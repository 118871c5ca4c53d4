// Uniform strains across the interface of two coupled bodies.
#include "tests/support/coupled_scene.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace fascia::test {
namespace {

constexpr double kTiny = 1e-3, kStretch = 1.1, kShear = 0.2;

const std::string kTop = "[materials.soft]\nyoung=1e4\npoisson=0.3\n[solver.newton]\ntolerance=1e-11\n";

std::string plane(std::size_t axis, double x) {
  Vector low{-kTiny, -kTiny, -kTiny}, high{2 + kTiny, 1 + kTiny, 1 + kTiny};
  low.at(axis) = x - kTiny;
  high.at(axis) = x + kTiny;
  return box(low, high);
}
const std::string kFace = plane(0, 1);

bool is_meshless(Kind kind) { return kind == Kind::grid || kind == Kind::scattered; }

struct Pair {
  const char* name;
  Kind left, right;
  int left_cells, right_cells;
  std::string share, coupling;
  std::string follower;  ///< the body whose nodes on the face depend on the other one
};

std::string bodies(const Pair& p) {
  return kTop + box_body("a", p.left, {0, 0, 0}, {1, 1, 1}, p.left_cells) +
         box_body("b", p.right, {1, 0, 0}, {2, 1, 1}, p.right_cells, p.share) + p.coupling;
}

const std::array<std::pair<const char*, Vector>, 7> kPoints{{{"a", {0.3, 0.4, 0.6}},
                                                            {"a", {0.9, 0.25, 0.7}},
                                                            {"a", {0.99, 0.5, 0.5}},
                                                            {"a", {1, 0.85, 0.35}},
                                                            {"b", {1.01, 0.5, 0.5}},
                                                            {"b", {1.1, 0.8, 0.35}},
                                                            {"b", {1.8, 0.65, 0.9}}}};

std::string probes() {
  std::string text;
  for (std::size_t k = 0; k < kPoints.size(); ++k) text += probe_at(fmt::format("p{}", k), kPoints[k].first, kPoints[k].second);
  return text;
}

/// Largest error over the largest displacement of the field.
template <typename Field>
double error_of(const TextRun& run, const Field& field) {
  double error = 0;
  for (std::size_t k = 0; k < kPoints.size(); ++k)
    error = std::max(error, length(run.vector(fmt::format("p{}", k)) - field(kPoints[k].second)));
  return error / length(field({2, 1, 1}));
}

/// Drawn along an axis, free to contract.
double stretched(const Pair& p, std::size_t along) {
  const char* names[] = {"x", "y", "z"};
  std::string text = bodies(p) + probes();
  const auto held = [&](const std::string& body, std::size_t axis, double x, double by) {
    std::string where = plane(axis, x);
    if (body == p.follower) where = fmt::format("{{all_of=[{},{{not={}}}]}}", where, kFace);
    Vector move{};
    move.at(axis) = by;
    const char* turns = is_meshless(body == "a" ? p.left : p.right) ? ",\"rx\",\"ry\",\"rz\"" : "";
    text += fix(body, where, fmt::format("move={{translate={},axes=[\"{}\"{}]}}", list(move), names[axis], turns));
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis == 0) {
      held("a", 0, 0, 0);
      if (along == 0) held("b", 0, 2, 2 * (kStretch - 1));
      continue;
    }
    for (const std::string body : {"a", "b"}) {
      held(body, axis, 0, 0);
      if (axis == along) held(body, axis, 1, kStretch - 1);
    }
  }
  const double narrow = std::sqrt(1 - 0.3 * (kStretch * kStretch - 1));
  return error_of(TextRun(text), [&](const Vector& X) {
    Vector u = X * (narrow - 1);
    u.at(along) = X.at(along) * (kStretch - 1);
    return u;
  });
}

/// u_x = 0.2 z + 0.1 y, frames turned likewise, on the whole outer boundary.
double sheared(const Pair& p) {
  std::string text = bodies(p) + probes();
  for (const auto& [body, n, kind] : {std::tuple{"a", p.left_cells, p.left}, std::tuple{"b", p.right_cells, p.right}})
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j) {
        const double y = static_cast<double>(j) / n, z = static_cast<double>(k) / n;
        const bool edge = j == 0 || k == 0 || j == n || k == n;
        std::string where = box({-kTiny, y - kTiny, z - kTiny}, {2 + kTiny, y + kTiny, z + kTiny});
        const std::string ends = fmt::format("{{any_of=[{},{}]}}", plane(0, 0), plane(0, 2));
        if (!edge) where = fmt::format("{{all_of=[{},{}]}}", where, ends);
        if (body == p.follower) where = fmt::format("{{all_of=[{},{{not={}}}]}}", where, kFace);
        text += fix(body, where,
                    fmt::format("move={{translate=[{:.17g},0,0],axes=[\"x\",\"y\",\"z\"]}}", kShear * z + 0.1 * y));
      }
  return error_of(TextRun(text), [](const Vector& X) { return Vector{kShear * X[2] + 0.1 * X[1], 0, 0}; });
}

TEST(CouplingPatch, Explore) {
  const std::string face = fmt::format("{{body=\"a\",where={}}}", kFace);
  const std::string still = fmt::format("{{body=\"a\",where={},rotations=false}}", kFace);
  const std::string a_in_b = coupling("join", "embed", "a", kFace, "to=\"b\"");
  const std::string b_in_a = coupling("join", "embed", "b", kFace, "to=\"a\"");
  const Pair pairs[] = {
      {"grid shares grid", Kind::grid, Kind::grid, 2, 2, face, "", ""},
      {"grid shares tetrahedra", Kind::tetrahedra, Kind::grid, 2, 2, face, "", ""},
      {"grid shares tetrahedra, still", Kind::tetrahedra, Kind::grid, 2, 2, still, "", ""},
      {"grid shares hexahedra, still", Kind::hexahedra, Kind::grid, 2, 2, still, "", ""},
      {"tetrahedra embedded in grid", Kind::tetrahedra, Kind::grid, 2, 2, "", a_in_b, "a"},
      {"grid embedded in tetrahedra", Kind::tetrahedra, Kind::grid, 2, 2, "", b_in_a, "b"},
      {"grid embedded in hexahedra", Kind::hexahedra, Kind::grid, 2, 2, "", b_in_a, "b"},
      {"hexahedra embedded in tetrahedra", Kind::tetrahedra, Kind::hexahedra, 2, 2, "", b_in_a, "b"},
      {"tetrahedra embedded in hexahedra", Kind::tetrahedra, Kind::hexahedra, 2, 2, "", a_in_b, "a"},
      {"hexahedra 4 in hexahedra 2", Kind::hexahedra, Kind::hexahedra, 2, 4, "", b_in_a, "b"},
      {"tetrahedra 4 in tetrahedra 2", Kind::tetrahedra, Kind::tetrahedra, 2, 4, "", b_in_a, "b"},
      {"tetrahedra 4 in grid 2", Kind::grid, Kind::tetrahedra, 2, 4, "", b_in_a, "b"},
      {"grid 4 in grid 2", Kind::grid, Kind::grid, 2, 4, "", b_in_a, "b"},
      {"grid 4 in hexahedra 2", Kind::hexahedra, Kind::grid, 2, 4, "", b_in_a, "b"},
      {"hexahedra 4 in tetrahedra 2", Kind::tetrahedra, Kind::hexahedra, 2, 4, "", b_in_a, "b"},
      {"hexahedra 3 in hexahedra 2", Kind::hexahedra, Kind::hexahedra, 2, 3, "", b_in_a, "b"},
      {"hexahedra 2 in hexahedra 4", Kind::hexahedra, Kind::hexahedra, 4, 2, "", b_in_a, "b"},
      {"scattered alone", Kind::scattered, Kind::scattered, 4, 4, face, "", ""},
      {"scattered shares grid", Kind::grid, Kind::scattered, 4, 4, face, "", ""},
      {"scattered shares tetrahedra", Kind::tetrahedra, Kind::scattered, 4, 4, face, "", ""},
      {"scattered shares tetrahedra, still", Kind::tetrahedra, Kind::scattered, 4, 4, still, "", ""},
      {"scattered embedded in tetrahedra", Kind::tetrahedra, Kind::scattered, 4, 4, "", b_in_a, "b"},
  };
  std::printf("%-36s %12s %12s %12s\n", "", "across", "along", "sheared");
  for (const Pair& p : pairs) {
    std::printf("%-36s %12.1e %12.1e", p.name, stretched(p, 0), stretched(p, 2));
    if (p.right != Kind::scattered) std::printf(" %12.1e", sheared(p));
    std::printf("\n");
  }
}

}  // namespace
}  // namespace fascia::test
