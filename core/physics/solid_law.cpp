#include "core/physics/solid_law.hpp"

#include "core/base/errors.hpp"

#include <cmath>
#include <string>

namespace fascia {

void check_own_constants(Law law, const LawConstants& constants) {
  const auto count = static_cast<std::size_t>(own_constant_count(law));
  if (count > 0 && constants.own.size() != count)
    throw InputError("a point has " + std::to_string(constants.own.size()) + " constants of its law's own; must have " +
                     std::to_string(count));
}

void check_viscosity(Law law, const Viscosity& viscosity, double stiffness_damping) {
  for (const ViscousBranch& branch : viscosity.branches)
    if (!(branch.share > 0) || !(branch.time > 0) || !std::isfinite(branch.time))
      throw InputError("a branch of a viscosity has the share " + std::to_string(branch.share) + " and the time " +
                       std::to_string(branch.time) + " s; both must be above 0");
  if (!(viscosity.long_term() > kLeastLasting))
    throw InputError("the shares of a viscosity leave " + std::to_string(viscosity.long_term()) +
                     " of the stiffness; must leave more than a millionth");
  if (stiffness_damping > 0)
    throw InputError("a material has a viscosity and stiffness damping; must have one of them");
  if (viscosity.shear_only && is_thin(law))
    throw InputError("a thin body's viscosity is that of the shear modulus alone; must be that of all its stiffness");
}

}  // namespace fascia
