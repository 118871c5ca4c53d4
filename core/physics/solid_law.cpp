#include "core/physics/solid_law.hpp"

#include "core/base/errors.hpp"

#include <string>

namespace fascia {

void check_own_constants(Law law, const LawConstants& constants) {
  const auto count = static_cast<std::size_t>(own_constant_count(law));
  if (count > 0 && constants.own.size() != count)
    throw InputError("a point has " + std::to_string(constants.own.size()) + " constants of its law's own; must have " +
                     std::to_string(count));
}

}  // namespace fascia
