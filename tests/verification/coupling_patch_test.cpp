// Uniform strains across the interface of two coupled bodies.
#include "tests/support/cases.hpp"
#include "tests/support/coupled_scene.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace fascia::test::coupling_patch_test {
namespace {

constexpr double kTiny = 1e-3, kStretch = 1.1;

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
  bool always = true;    ///< not in full size alone
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
  for (std::size_t k = 0; k < kPoints.size(); ++k)
    text += probe_at(fmt::format("p{}", k), kPoints[k].first, kPoints[k].second);
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

/// A strain without rotation, so that the frames on the boundary keep theirs.
Vector strained(const Vector& X) {
  return {0.05 * X[0] + 0.1 * X[1] + 0.15 * X[2], 0.1 * X[0] - 0.04 * X[1], 0.15 * X[0] + 0.02 * X[2]};
}

/// Prescribed at every node of the whole outer boundary.
double held_all_round(const Pair& p) {
  std::string text = bodies(p) + probes();
  for (const auto& [body, n, kind, first] :
       {std::tuple{"a", p.left_cells, p.left, 0}, std::tuple{"b", p.right_cells, p.right, 1}})
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
          const bool outer = j == 0 || k == 0 || j == n || k == n || i == (first == 0 ? 0 : n);
          const bool face = i == (first == 0 ? n : 0);
          if (!outer || (face && body == p.follower)) continue;
          const Vector X =
              Vector{first + static_cast<double>(i) / n, static_cast<double>(j) / n, static_cast<double>(k) / n};
          const char* axes = is_meshless(kind) ? "\"x\",\"y\",\"z\",\"rx\",\"ry\",\"rz\"" : "\"x\",\"y\",\"z\"";
          text += fix(body, fmt::format("{{nearest={}}}", list(X)),
                      fmt::format("move={{translate={},axes=[{}]}}", list(strained(X)), axes));
        }
  return error_of(TextRun(text), strained);
}

/// Exact where the fields of both sides agree on the face and both balance a uniform stress. Elsewhere the error falls
/// with the cells' size: triangles beside squares, frames that turn freely where they are embedded, points beside still
/// vertices, which take displacements alone, scattered points.
TEST(CouplingPatch, UniformStrains) {
  const std::string face = fmt::format("{{body=\"a\",where={}}}", kFace);
  const std::string still = fmt::format("{{body=\"a\",where={},rotations=false}}", kFace);
  const std::string a_in_b = coupling("join", "embed", "a", kFace, "to=\"b\"");
  const std::string b_in_a = coupling("join", "embed", "b", kFace, "to=\"a\"");
  const Pair pairs[] = {
      {"grid shares grid", Kind::grid, Kind::grid, 2, 2, face, "", ""},
      {"grid shares tetrahedra", Kind::tetrahedra, Kind::grid, 2, 2, face, "", "", false},
      {"grid shares tetrahedra, still", Kind::tetrahedra, Kind::grid, 2, 2, still, "", ""},
      {"grid shares hexahedra, still", Kind::hexahedra, Kind::grid, 2, 2, still, "", "", false},
      {"tetrahedra embedded in grid", Kind::tetrahedra, Kind::grid, 2, 2, "", a_in_b, "a"},
      {"grid embedded in tetrahedra", Kind::tetrahedra, Kind::grid, 2, 2, "", b_in_a, "b", false},
      {"grid embedded in hexahedra", Kind::hexahedra, Kind::grid, 2, 2, "", b_in_a, "b"},
      {"hexahedra embedded in tetrahedra", Kind::tetrahedra, Kind::hexahedra, 2, 2, "", b_in_a, "b"},
      {"tetrahedra embedded in hexahedra", Kind::tetrahedra, Kind::hexahedra, 2, 2, "", a_in_b, "a", false},
      {"hexahedra 4 in hexahedra 2", Kind::hexahedra, Kind::hexahedra, 2, 4, "", b_in_a, "b"},
      {"tetrahedra 4 in tetrahedra 2", Kind::tetrahedra, Kind::tetrahedra, 2, 4, "", b_in_a, "b", false},
      {"tetrahedra 4 in grid 2", Kind::grid, Kind::tetrahedra, 2, 4, "", b_in_a, "b", false},
      {"grid 4 in grid 2", Kind::grid, Kind::grid, 2, 4, "", b_in_a, "b"},
      {"grid 4 in hexahedra 2", Kind::hexahedra, Kind::grid, 2, 4, "", b_in_a, "b"},
      {"hexahedra 4 in tetrahedra 2", Kind::tetrahedra, Kind::hexahedra, 2, 4, "", b_in_a, "b", false},
      {"hexahedra 3 in hexahedra 2", Kind::hexahedra, Kind::hexahedra, 2, 3, "", b_in_a, "b", false},
      {"hexahedra 2 in hexahedra 4", Kind::hexahedra, Kind::hexahedra, 4, 2, "", b_in_a, "b"},
      {"scattered shares grid", Kind::grid, Kind::scattered, 3, 3, face, "", "", false},
      {"scattered shares tetrahedra", Kind::tetrahedra, Kind::scattered, 3, 3, face, "", "", false},
      {"scattered shares tetrahedra, still", Kind::tetrahedra, Kind::scattered, 3, 3, still, "", ""},
      {"scattered embedded in tetrahedra", Kind::tetrahedra, Kind::scattered, 3, 3, "", b_in_a, "b"},
  };
  std::printf("%-36s %12s %12s %12s\n", "error over the displacement", "across", "along", "all round");
  for (const Pair& p : pairs) {
    if (!p.always && !full_size()) continue;
    const double across = stretched(p, 0), along = stretched(p, 2);
    std::printf("%-36s %12.1e %12.1e", p.name, across, along);
    const bool exact =
        p.right == p.left && (p.left == Kind::grid ? p.follower.empty() : p.right_cells % p.left_cells == 0);
    if (exact) {
      EXPECT_LT(std::max(across, along), 1e-9) << p.name;
    }
    if (p.right != Kind::scattered) {
      const double all_round = held_all_round(p);
      std::printf(" %12.1e", all_round);
      if (exact) {
        EXPECT_LT(all_round, 1e-9) << p.name;
      }
    }
    std::printf("\n");
    EXPECT_LT(std::max(across, along), 0.25) << p.name;
  }
}

}  // namespace
}  // namespace fascia::test::coupling_patch_test
