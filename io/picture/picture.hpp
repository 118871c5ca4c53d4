#pragma once

#include "io/picture/marks.hpp"
#include "io/picture/results.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::io {

/// How a picture looks.
struct PictureStyle {
  Vec3d view{{1, 1, 1}};                       ///< from the bodies towards the eye
  std::optional<Vec3d> up;                     ///< see view_along
  std::array<int, 2> size{1200, 800};          ///< pixels
  std::string field;                           ///< on the legend; no legend where empty
  std::string title;                           ///< above the picture
  std::optional<std::array<double, 2>> range;  ///< of the colours, in SI; default: that of the values
  bool relative = false;                       ///< the values of each state are parts of its largest one
  bool frames = false;                         ///< show them as small balls, in front of the surface
  bool rest = true;                            ///< show the outline at rest, where it lies elsewhere
};

/// A state of all bodies.
struct PictureState {
  std::vector<PictureBody> bodies;
  Marks marks;
  std::string label;  ///< "t = 0.4 s"
};

/// Renders a state, or several side by side and alike, coloured over their common range, into a PNG: surfaces from both
/// sides, lines as tubes, supports, springs and the outline at rest, with a legend, the axes and a scale bar. A picture
/// of less than 160 x 120 pixels shows the bodies only. Needs a DisplayConnection.
/// @throws InputError  where no body has anything to show
/// @throws FileError   where the file cannot be written
void render_picture(std::vector<PictureState> states, const PictureStyle& style, const std::filesystem::path& png);

}  // namespace fascia::io
