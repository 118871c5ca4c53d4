#pragma once

namespace fascia {

/// How an element's strain makes stress (core/physics/element_law.hpp).
enum class ElementLaw : unsigned char { linear, corotational, st_venant_kirchhoff, neo_hookean };

}  // namespace fascia
