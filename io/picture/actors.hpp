#pragma once

#include "io/picture/marks.hpp"
#include "io/picture/results.hpp"
#include "io/picture/view.hpp"

#include <vtkLookupTable.h>
#include <vtkRenderer.h>

/// Parts of a picture as actors, where a Placing puts them. An empty part adds nothing.
namespace fascia::io {

bool has_points(vtkPolyData* part);

/// Sizes [m] but for lines.
struct Thickness {
  double tube = 0;    ///< radius of lines
  double ball = 0;    ///< radius of frames
  double mark = 0;    ///< edge of a support's cube
  double pixel = 0;   ///< how much of the bodies one pixel shows
  double stroke = 1;  ///< width of drawn lines [pixels]
};

/// The faces, smooth but for creases, seen and lit from both sides.
/// @param colors  of the values shown; tissue where null
void add_surface(vtkRenderer& renderer, const PictureBody& body, const Placing& placing, vtkLookupTable* colors);

/// Faint lines along the edges of the faces, lighter where they are many.
void add_edges(vtkRenderer& renderer, const PictureBody& body, const Placing& placing, const Thickness& thickness);

/// The lines as round tubes.
void add_lines(vtkRenderer& renderer, const PictureBody& body, const Placing& placing, vtkLookupTable* colors,
               const Thickness& thickness);

/// The frames as balls.
void add_frames(vtkRenderer& renderer, const PictureBody& body, const Placing& placing, const Thickness& thickness);

/// The outline of the shape at rest.
void add_rest(vtkRenderer& renderer, const PictureBody& body, const Placing& placing, const Thickness& thickness);

/// Cubes where material is held, balls where it is held in part, and springs as lines to a cube at their anchor.
void add_marks(vtkRenderer& renderer, const Marks& marks, const Placing& placing, const Thickness& thickness);

}  // namespace fascia::io
