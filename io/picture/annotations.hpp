#pragma once

#include "io/picture/canvas.hpp"
#include "io/picture/view.hpp"

#include <string>
#include <vector>

namespace fascia::io {

inline constexpr Color rest_color{0.62, 0.62, 0.65}, mark_color{0.52, 0.56, 0.64}, spring_color{0.25, 0.40, 0.58},
    frame_color{0.85, 0.20, 0.15};

/// The axes x, y, z as they lie in the picture. @param center, radius  [pixels]
void draw_axes(Canvas& canvas, Pixel center, double radius, int font, const View& view);

/// A bar of a round length.
struct ScaleBar {
  double length = 1;  ///< [m]
  double width = 0;   ///< [pixels]
  std::string text;
};

/// @param metre  its length in the picture [pixels]; @param widest  that the bar may be [pixels]
ScaleBar scale_bar(double metre, double widest);

/// @param left  the bar's left end; its text stands above it
void draw_scale_bar(Canvas& canvas, Pixel left, int font, const ScaleBar& bar);

/// Signs of a picture that a reader may not know.
enum class Sign { rest, support, partial_support, spring, frame };

/// Names the signs in rows of this width [pixels] from `low` upwards, at most two; signs that find no room are left
/// out.
void draw_key(Canvas& canvas, Pixel low, double width, int font, const std::vector<Sign>& signs);

}  // namespace fascia::io
