#pragma once

namespace fascia::test {

/// A cube whose one face moves onto the other within a second: J = 0 in the last step, where stresses have no value.
inline constexpr const char* kCrushedCube = R"(
[bodies.c]
model = "hexahedra"
domain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = [1, 1, 1] } }
density = 1000
material = { young = 1e4, poisson = 0.0 }
[[constraints]]
body = "c"
where = { box = { min = [-0.1, -0.1, -0.1], max = [0.01, 2, 2] } }
fix = "all"
[[constraints]]
body = "c"
where = { box = { min = [0.99, -0.1, -0.1], max = [1.01, 2, 2] } }
move = { translate = [-1, 0, 0] }
over = "1 s"
[solver]
kind = "implicit-euler"
time_step = "40 ms"
duration = "1 s"
)";

/// A probe of its stress, which is not finite there.
inline constexpr const char* kStressProbe = R"([probes.s]
body = "c"
at = [0.5, 0.5, 0.5]
quantity = "stress"
)";

}  // namespace fascia::test
