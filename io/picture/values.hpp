#pragma once

#include "io/picture/legend.hpp"
#include "io/picture/picture.hpp"

namespace fascia::io {

/// Divides the values of a state by the largest absolute one.
void make_relative(PictureState& state);

/// The range of all values, or the one that the style gives, with the words for its legend.
ColorScale scale_of(const std::vector<PictureState>& states, const PictureStyle& style);

}  // namespace fascia::io
