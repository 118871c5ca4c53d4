#pragma once

#include "io/picture/results.hpp"

namespace fascia::io {

/// How a picture looks.
struct PictureStyle {
  std::array<double, 3> view{1, 1, 1};  ///< from the bodies towards the eye
  std::array<double, 3> up{0, 0, 0};    ///< zero: y, or z where one looks along y
  std::array<int, 2> size{1200, 800};   ///< pixels
  std::string field;                    ///< name on the scale; no scale where empty
  std::string title;
  bool frames = false;  ///< show them as small balls, in front of the surface
};

/// Renders the bodies, coloured over their common range, into a PNG: surfaces from both sides, lines as tubes whose
/// diameter is 0.6 % of the bounding box's diagonal. Needs a DisplayConnection.
/// @throws InputError  where no body has anything to show
/// @throws FileError   where the file cannot be written
void render_picture(const std::vector<PictureBody>& bodies, const PictureStyle& style,
                    const std::filesystem::path& png);

}  // namespace fascia::io
