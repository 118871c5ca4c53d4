#pragma once

#include "assembly/specification/errors.hpp"
#include "assembly/specification/scene.hpp"

#include <string>
#include <vector>

namespace fascia {

/// Orthonormal rows, to the digits that people write.
bool is_orthonormal(const Mat3d& axes);

/// Looks at parts of a specification, each by itself, and notes what is wrong with them.
class CheckParts {
 public:
  /// @param wrong  takes the notes; stays with the caller
  explicit CheckParts(std::vector<Diagnostic>& wrong) : wrong_(wrong) {}

  void wrong(const Place& place, std::string message) { wrong_.push_back({place, std::move(message)}); }
  void finite(double value, const Place& place);
  void finite(const Vec3d& v, const Place& place);
  void positive(double value, const Place& place, const char* name);
  void at_least_zero(double value, const Place& place, const char* name);
  void unit(const Vec3d& v, const Place& place, const char* name);
  void counts(const std::vector<int>& count, std::size_t size, int least, const Place& place);

  void region(const Region& region, const Place& place, int depth = 0);
  void schedule(const Schedule& schedule, const Place& place);
  void motion(const Motion& motion, const Place& place);
  /// @param small  the body takes laws of small strain, or St Venant-Kirchhoff, alone
  void material(const Material& material, bool small);
  void fluid(const Fluid& fluid);
  /// Fibres of a material, and the stress along them.
  void fibres(const Material& material);
  /// The numbers of a domain, and the transform.
  void domain(const Body& body);
  void solver(const Solver& solver);

 private:
  std::vector<Diagnostic>& wrong_;
};

}  // namespace fascia
