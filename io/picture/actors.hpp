#pragma once

#include "io/picture/results.hpp"

#include <vtkLookupTable.h>
#include <vtkRenderer.h>

namespace fascia::io {

bool has_points(vtkPolyData* part);

/// The faces, smooth but for creases, seen and lit from both sides. An empty part adds nothing; here and below.
/// @param colors  of the values shown; tissue where null
void add_surface(vtkRenderer& renderer, const PictureBody& body, vtkLookupTable* colors);

/// Faint lines along the edges of the faces, lighter where they are many.
void add_edges(vtkRenderer& renderer, const PictureBody& body);

/// The lines as round tubes. @param radius  [m]
void add_lines(vtkRenderer& renderer, const PictureBody& body, vtkLookupTable* colors, double radius);

/// The frames as balls. @param radius  [m]
void add_frames(vtkRenderer& renderer, const PictureBody& body, double radius);

}  // namespace fascia::io
