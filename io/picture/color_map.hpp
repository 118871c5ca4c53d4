#pragma once

#include <vtkLookupTable.h>
#include <vtkSmartPointer.h>

namespace fascia::io {

/// Dark violet over green to yellow, even steps of lightness: readable in grey and for the colour-blind (after
/// viridis).
/// @param low, high  range of the values; low < high
vtkSmartPointer<vtkLookupTable> perceptual_colors(double low, double high);

}  // namespace fascia::io
