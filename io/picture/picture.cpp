#include "io/picture/picture.hpp"

#include "core/model/errors.hpp"
#include "io/files.hpp"
#include "io/picture/actors.hpp"
#include "io/picture/color_map.hpp"
#include "io/vtk_errors.hpp"

#include <vtkBoundingBox.h>
#include <vtkCamera.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace fascia::io {
namespace {

constexpr double ink[3]{0.13, 0.13, 0.15};
constexpr double tube_radius = 0.003;  // of the box's diagonal
constexpr double ball_radius = 0.006;

/// Around all that is coloured, with its tubes; around the frames where nothing is.
vtkBoundingBox bounds_of(const std::vector<PictureBody>& bodies) {
  vtkBoundingBox box, frames;
  bool lines = false;
  for (const PictureBody& body : bodies) {
    lines = lines || has_points(body.lines);
    if (has_points(body.surface)) box.AddBounds(body.surface->GetBounds());
    if (has_points(body.lines)) box.AddBounds(body.lines->GetBounds());
    if (has_points(body.frames)) frames.AddBounds(body.frames->GetBounds());
  }
  if (!box.IsValid()) box = frames;
  if (!(box.GetDiagonalLength() > 0)) {  // a single point: room around it, in its own scale
    double x[3];
    box.GetCenter(x);
    const double distance = std::hypot(x[0], x[1], x[2]);
    box.Inflate(distance > 0 ? 0.01 * distance : 1);
  }
  if (lines) box.Inflate(tube_radius * box.GetDiagonalLength());
  return box;
}

/// The common range, opened a little where all values are equal.
std::array<double, 2> range_of(const std::vector<PictureBody>& bodies) {
  std::array<double, 2> range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const PictureBody& body : bodies)
    for (const auto& part : {body.surface, body.lines}) {
      if (!has_points(part)) continue;
      double own[2];
      vtkDataArray* values = part->GetPointData()->GetScalars();
      if (!values) values = part->GetCellData()->GetScalars();
      if (!values) continue;  // lines, where a cell field is shown
      values->GetRange(own);
      range = {std::min(range[0], own[0]), std::max(range[1], own[1])};
    }
  if (range[0] > range[1]) return {0, 1};
  if (!(range[0] < range[1])) range[1] = range[0] + std::max(1e-12, 1e-6 * std::abs(range[0]));
  return range;
}

vtkTextProperty* styled(vtkTextProperty* text, int size, bool bold) {
  text->SetColor(ink[0], ink[1], ink[2]);
  text->SetFontFamilyToArial();
  text->SetFontSize(size);
  text->SetBold(bold);
  text->SetItalic(false);
  text->SetShadow(false);
  return text;
}

void add_scale(vtkRenderer& renderer, vtkLookupTable* colors, const PictureStyle& style) {
  const int font = std::clamp(style.size[1] / 40, 10, 40);
  vtkNew<vtkScalarBarActor> scale;
  scale->SetLookupTable(colors);
  std::string name = style.field;
  std::replace(name.begin(), name.end(), '_', ' ');
  scale->SetTitle(name.c_str());
  scale->SetNumberOfLabels(5);
  scale->SetLabelFormat(" %.4g");
  scale->UnconstrainedFontSizeOn();
  scale->SetVerticalTitleSeparation(font);
  styled(scale->GetTitleTextProperty(), font, true);
  styled(scale->GetLabelTextProperty(), font, false);
  scale->SetPosition(0.86, 0.15);
  scale->SetWidth(0.10);
  scale->SetHeight(0.70);
  scale->SetBarRatio(0.25);
  renderer.AddActor2D(scale);
}

void add_title(vtkRenderer& renderer, const PictureStyle& style) {
  const int font = std::clamp(style.size[1] / 30, 12, 48);
  vtkNew<vtkTextActor> title;
  title->SetInput(style.title.c_str());
  styled(title->GetTextProperty(), font, true);
  title->GetTextProperty()->SetVerticalJustificationToTop();
  title->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  title->SetPosition(0.025, 0.97);
  renderer.AddActor2D(title);
}

/// Looks along −view, so that all corners of the bounding box fill the space left of the scale.
void place_camera(vtkRenderer& renderer, const vtkBoundingBox& box, const PictureStyle& style) {
  std::array<double, 3> up = style.up;
  if (up == std::array<double, 3>{0, 0, 0}) {
    const double length = std::hypot(style.view[0], style.view[1], style.view[2]);
    up = std::abs(style.view[1]) > 0.98 * length ? std::array<double, 3>{0, 0, 1} : std::array<double, 3>{0, 1, 0};
  }
  double center[3];
  box.GetCenter(center);
  vtkCamera* camera = renderer.GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetFocalPoint(center);
  camera->SetPosition(center[0] + style.view[0], center[1] + style.view[1], center[2] + style.view[2]);
  camera->SetViewUp(up.data());
  camera->OrthogonalizeViewUp();
  double bounds[6];
  box.GetBounds(bounds);
  renderer.ResetCamera(bounds);

  const double* v = camera->GetViewUp();
  const double* n = camera->GetDirectionOfProjection();
  const double side[3]{n[1] * v[2] - n[2] * v[1], n[2] * v[0] - n[0] * v[2], n[0] * v[1] - n[1] * v[0]};
  double half_width = 0, half_height = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double x[3], across = 0, along = 0;
    box.GetCorner(corner, x);
    for (int c = 0; c < 3; ++c) {
      across += (x[c] - center[c]) * side[c];
      along += (x[c] - center[c]) * v[c];
    }
    half_width = std::max(half_width, std::abs(across));
    half_height = std::max(half_height, std::abs(along));
  }
  const double used_width = style.field.empty() ? 0.92 : 0.76, used_height = style.title.empty() ? 0.90 : 0.82;
  const double aspect = static_cast<double>(style.size[0]) / style.size[1];
  camera->SetParallelScale(std::max(half_height / used_height, half_width / (used_width * aspect)));
  camera->SetWindowCenter(style.field.empty() ? 0 : 0.12, style.title.empty() ? 0 : 0.04);
}

void write_png(vtkRenderWindow& window, const std::filesystem::path& png) {
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(&window);
  image->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  if (!bytes || bytes->GetNumberOfValues() == 0) throw FileError(png.string() + ": the picture could not be rendered");
  write_file(png, std::string_view(reinterpret_cast<const char*>(bytes->GetPointer(0)),
                                   static_cast<std::size_t>(bytes->GetNumberOfValues())));
}

}  // namespace

void render_picture(const std::vector<PictureBody>& bodies, const PictureStyle& style,
                    const std::filesystem::path& png) {
  const bool anything = std::any_of(bodies.begin(), bodies.end(), [&](const PictureBody& body) {
    return has_points(body.surface) || has_points(body.lines) || (style.frames && has_points(body.frames));
  });
  if (!anything) throw InputError(png.string() + ": the results have no volume cells, triangles or lines to show");
  VtkErrors errors;
  const vtkBoundingBox box = bounds_of(bodies);
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1, 1, 1);
  vtkNew<vtkRenderer> in_front;  // a layer of its own, so that the surface hides nothing of it
  in_front->SetLayer(1);
  in_front->SetActiveCamera(renderer->GetActiveCamera());
  vtkSmartPointer<vtkLookupTable> colors;
  if (!style.field.empty()) {
    const std::array<double, 2> range = range_of(bodies);
    colors = perceptual_colors(range[0], range[1]);
    add_scale(*renderer, colors, style);
  }
  for (const PictureBody& body : bodies) {
    add_surface(*renderer, body, colors);
    add_edges(*renderer, body);
    add_lines(*renderer, body, colors, tube_radius * box.GetDiagonalLength());
    if (style.frames) add_frames(*in_front, body, ball_radius * box.GetDiagonalLength());
  }
  if (!style.title.empty()) add_title(*renderer, style);

  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(true);
  window->SetMultiSamples(8);
  window->SetSize(style.size[0], style.size[1]);
  window->SetNumberOfLayers(2);
  window->AddRenderer(renderer);
  window->AddRenderer(in_front);
  place_camera(*renderer, box, style);
  window->Render();
  if (!errors.first().empty()) throw FileError(png.string() + ": cannot be rendered: " + errors.first());
  write_png(*window, png);
}

}  // namespace fascia::io
