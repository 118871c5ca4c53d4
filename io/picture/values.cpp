#include "io/picture/values.hpp"

#include "io/quantity.hpp"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

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

std::array<double, 2> range_of(const PictureState& state) {
  std::array<double, 2> range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (vtkDataArray* values : values_of(state)) {
    double own[2];
    values->GetRange(own);
    range = {std::min(range[0], own[0]), std::max(range[1], own[1])};
  }
  return range[0] > range[1] ? std::array<double, 2>{0, 0} : range;
}

}  // namespace

void make_relative(PictureState& state) {
  const auto [low, high] = range_of(state);
  const double largest = std::max(std::abs(low), std::abs(high));
  if (!(largest > 0)) return;
  for (vtkDataArray* values : values_of(state)) {
    for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
      values->SetComponent(i, 0, values->GetComponent(i, 0) / largest);
    values->Modified();
  }
}

ColorScale scale_of(const std::vector<PictureState>& states, const PictureStyle& style) {
  constexpr double rounding = 1e-6;  // of the largest value: differences below are those of solvers
  const FieldName name = name_of_field(style.field);
  ColorScale scale{name.words, name.unit};
  if (style.relative) scale = {name.words + ", relative", "1"};
  std::array<double, 2> range = range_of(states.front());
  for (const PictureState& state : states) {
    const auto [low, high] = range_of(state);
    range = {std::min(range[0], low), std::max(range[1], high)};
  }
  const double largest = std::max(std::abs(range[0]), std::abs(range[1]));
  if (style.range) {
    scale.below = range[0] < (*style.range)[0] - rounding * largest;
    scale.above = range[1] > (*style.range)[1] + rounding * largest;
    range = *style.range;
  }
  if (range[1] - range[0] <= rounding * largest) range[1] = range[0];
  scale.low = range[0];
  scale.high = range[1];
  return scale;
}

}  // namespace fascia::io
