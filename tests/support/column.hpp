#pragma once

#include <string>

namespace fascia::test {

/// A column 2 m long and 0.1 m wide, clamped at its foot. Euler: π² E I / (4 L²) = 5.140 N for 1 MPa.
inline std::string column(double force) {
  return R"(
[bodies.c]
model = "hexahedra"
order = 2
domain = { box = { min = [0, -0.05, -0.05], max = [2, 0.05, 0.05], cells = [20, 2, 2] } }
density = 1000
material = { young = 1e6, poisson = 0.0 }
[[constraints]]
body = "c"
where = { box = { min = [-0.1, -1, -1], max = [0.0001, 2, 2] } }
fix = "all"
[[loads]]
body = "c"
where = { box = { min = [1.9999, -1, -1], max = [2.01, 2, 2] } }
total_force = [)" +
         std::to_string(-force) + R"(, 0, 0]
[solver]
kind = "static"
[probes.tip]
body = "c"
at = [2, 0, 0]
quantity = "displacement"
)";
}

inline constexpr double kEuler = 5.140;  // [N]

}  // namespace fascia::test
