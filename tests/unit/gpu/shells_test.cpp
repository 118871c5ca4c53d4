#include "gpu/blocks/shells.hpp"
#include "tests/support/shell_models.hpp"
#include "tests/unit/gpu/host_model.hpp"

#include <ostream>
#include <string>

/// Shells of the GPU backend, run on the processor, against the executor.
namespace fascia::shells_test {
namespace {

using namespace test;
using HostShells = gpu::Shells<HostSpace>;

struct Case {
  std::string name;
  ShellMatter matter;
  double rotation = 0.4;  ///< of the frames [rad]
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

Vec3d dome(double u, double v) { return {{u, v, 0.6 * u * (1 - u) + 0.3 * u * v}}; }

/// 18 triangles: lanes are left over.
ShellMesh mesh() { return patch_mesh(dome, {3, 3, Diagonals::alternating, 0.2}); }

class GpuShells : public testing::TestWithParam<Case> {};

TEST_P(GpuShells, AgreeWithTheExecutor) {
  const ShellModel built = shell_model(mesh(), GetParam().matter);
  Comparison<HostShells> comparison(built.model, random_state(built.model, 0.02, GetParam().rotation),
                                    random_state(built.model, 0.01, 0.2, 7),
                                    GetParam().matter.stiffness_damping > 0 ? 0.05 : 0);
  comparison.expect_all();
}

INSTANTIATE_TEST_SUITE_P(Matter, GpuShells,
                         testing::Values(Case{"thick", {1e4, 0.3, 0.2}}, Case{"thin", {1e4, 0.45, 0.01}},
                                         Case{"much_turned", {1e4, 0.3, 0.2}, 1.2},
                                         Case{"hardly_turned", {1e4, 0.3, 0.2}, 1e-3},
                                         Case{"fading", {.thickness = 0.05, .viscosity = two_branches()}},
                                         Case{"damped", {1e4, 0.3, 0.05, 1000, 0.02}}),
                         [](const auto& parameter) { return parameter.param.name; });

/// In one block some triangles fade and others damp.
TEST(GpuShellBodies, FadingBesideDamped) {
  ShellBodySpec spec = shell_spec(mesh(), {.thickness = 0.05});
  for (std::size_t t = 0; t < spec.material.size(); ++t)
    if (t % 2 == 0)
      spec.material[t].viscosity = two_branches();
    else
      spec.material[t].stiffness_damping = 0.02;
  const ShellModel built = shell_model(std::move(spec));
  Comparison<HostShells> comparison(built.model, random_state(built.model, 0.02, 0.4),
                                    random_state(built.model, 0.01, 0.2, 7), 0.05);
  comparison.expect_all();
}

/// Two shells of different matter in one model: places of forces, strains and quantities of each.
TEST(GpuShellBodies, OfTwo) {
  Model model;
  PointSetBuilder points;
  std::vector<std::unique_ptr<ShellBody>> bodies;
  for (const ShellMatter& matter : {ShellMatter{1e4, 0.3, 0.2}, ShellMatter{2e4, 0.4, 0.05, 1000, 0.02}})
    bodies.push_back(std::make_unique<ShellBody>(shell_spec(mesh(), matter), model, points));
  model.points = std::move(points).finish(model.frame_kind);
  ASSERT_EQ(model.points.part_count(), 2);
  Comparison<HostShells> comparison(model, random_state(model, 0.02, 0.4), random_state(model, 0.01, 0.2, 7), 0.05);
  comparison.expect_all();
}

}  // namespace
}  // namespace fascia::shells_test
