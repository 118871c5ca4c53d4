#pragma once

#include <array>
#include <string>

/// Scenes of benchmarks as TOML. Each time step is the same work: one Newton iteration of 60 CG iterations.
namespace fascia::app {

/// A free beam of 40 × 10 × 10 cm that is pulled at both ends, with scattered frames and points: inverse squared
/// distances to the nearest frames.
/// @param frames, points  how they are sampled, as in a scene: poisson_disk = "10 mm", seed = 1
/// @param setting         "paper" or "default", as BenchmarkCase::setting
std::string scattered_beam(const std::string& title, const std::string& frames, const std::string& points,
                           int neighbours, const std::string& setting);

/// Table 3's beam has its frames on a grid here, with linear weights: four neighbours, 24 points a cell.
std::string grid_beam(const std::array<int, 3>& cells, const std::string& setting);

/// A clamped block of 10 × 10 × 20 cm, five tetrahedra a cell; or a hexahedron, of eight points.
std::string tetrahedra_scene(int x, int y, int z);
std::string hexahedra_scene(int x, int y, int z);

/// A plate of 1 × 1.6 m that sags between two clamped edges; two triangles a cell.
std::string shell_scene(int u, int v);

/// Two walls of n × n cells with tissue between them: table 2's coupling at n = 7.
/// @param frames, points  about so many of the tissue's own
std::string coupled_scene(int cells, int frames, int points);

}  // namespace fascia::app
