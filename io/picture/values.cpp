#include "io/picture/values.hpp"

#include "io/quantity.hpp"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>

namespace fascia::io {
namespace {

/// The arrays with the values shown, each once.
std::set<vtkDataArray*> values_of(const PictureState& state) {
  std::set<vtkDataArray*> arrays;
  for (const PictureBody& body : state.bodies)
    for (const auto& part : {body.surface, body.lines}) {
      vtkDataArray* values = part->GetPointData()->GetScalars();
      if (!values) values = part->GetCellData()->GetScalars();
      if (values && values->GetNumberOfTuples() > 0) arrays.insert(values);  // lines have none of a cell field
    }
  return arrays;
}

/// The range of all values; it is zero where there are none.
std::array<double, 2> range_of(std::span<const PictureState> states) {
  std::array<double, 2> range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const PictureState& state : states)
    for (vtkDataArray* values : values_of(state)) {
      double own[2];
      values->GetRange(own);
      range = {std::min(range[0], own[0]), std::max(range[1], own[1])};
    }
  return range[0] > range[1] ? std::array<double, 2>{0, 0} : range;
}

}  // namespace

void make_relative(PictureState& state) {
  const auto [low, high] = range_of(std::span(&state, 1));
  const double largest = std::max(std::abs(low), std::abs(high));
  if (!(largest > 0)) return;
  for (vtkDataArray* values : values_of(state)) {
    for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
      values->SetComponent(i, 0, values->GetComponent(i, 0) / largest);
    values->Modified();
  }
}

ColorScale scale_of(const std::vector<PictureState>& states, const PictureStyle& style) {
  constexpr double of_solvers = 1e-6;   // of the largest value: differences below tell nothing
  constexpr double of_numbers = 1e-12;  // of the larger end: a range that was asked for has ticks if it is wider
  constexpr double unseen = 1e-6;       // of the range: values so little beyond it have the colours of its ends
  const FieldName name = name_of_field(style.field);
  ColorScale scale{name.words, name.unit};
  if (style.relative) scale = {name.words + ", relative", "1"};
  std::array<double, 2> range = range_of(states);
  if (style.range) {
    const auto [low, high] = *style.range;
    scale.below = range[0] < low - unseen * (high - low);
    scale.above = range[1] > high + unseen * (high - low);
    range = *style.range;
  }
  const double largest = std::max(std::abs(range[0]), std::abs(range[1]));
  if (range[1] - range[0] <= (style.range ? of_numbers : of_solvers) * largest) range[1] = range[0];
  scale.low = range[0];
  scale.high = range[1];
  return scale;
}

}  // namespace fascia::io
