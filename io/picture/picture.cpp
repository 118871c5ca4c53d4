#include "io/picture/picture.hpp"

#include "core/model/errors.hpp"
#include "io/files.hpp"
#include "io/picture/color_map.hpp"
#include "io/vtk_errors.hpp"

#include <vtkActor.h>
#include <vtkBoundingBox.h>
#include <vtkCamera.h>
#include <vtkGlyph3DMapper.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkSphereSource.h>
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

vtkBoundingBox bounds_of(const std::vector<PictureBody>& bodies) {
  vtkBoundingBox box;
  for (const PictureBody& body : bodies) box.AddBounds(body.surface->GetBounds());
  return box;
}

/// The common range, opened a little where all values are equal.
std::array<double, 2> range_of(const std::vector<PictureBody>& bodies) {
  std::array<double, 2> range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const PictureBody& body : bodies) {
    double own[2];
    body.surface->GetPointData()->GetScalars()->GetRange(own);
    range = {std::min(range[0], own[0]), std::max(range[1], own[1])};
  }
  if (!(range[0] < range[1])) range[1] = range[0] + std::max(1e-12, 1e-6 * std::abs(range[0]));
  return range;
}

void add_surface(vtkRenderer& renderer, const PictureBody& body, vtkLookupTable* colors) {
  constexpr double crease = 35;  // degrees: sharper edges stay sharp
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(body.surface);
  normals->SetFeatureAngle(crease);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(normals->GetOutputPort());
  mapper->SetScalarVisibility(colors != nullptr);
  mapper->SetResolveCoincidentTopologyToPolygonOffset();
  mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(2, 2);  // behind the lines of its edges
  if (colors) {
    mapper->SetLookupTable(colors);
    mapper->UseLookupTableScalarRangeOn();
    mapper->InterpolateScalarsBeforeMappingOn();
  }
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* look = actor->GetProperty();
  look->SetColor(0.80, 0.55, 0.50);
  look->SetAmbient(0.4);
  look->SetDiffuse(0.65);
  look->SetSpecular(0.12);
  look->SetSpecularPower(25);
  renderer.AddActor(actor);
}

/// Faint lines along the triangles' edges, lighter where they are many.
void add_edges(vtkRenderer& renderer, const PictureBody& body) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(body.surface);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetRepresentationToWireframe();
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetColor(0.05, 0.05, 0.08);
  const double triangles = static_cast<double>(body.surface->GetNumberOfPolys());
  actor->GetProperty()->SetOpacity(std::clamp(0.32 - 0.05 * std::log10(1 + triangles), 0.08, 0.25));
  actor->GetProperty()->SetLineWidth(1);
  renderer.AddActor(actor);
}

void add_frames(vtkRenderer& renderer, const PictureBody& body, double radius) {
  if (body.frames->GetNumberOfPoints() == 0) return;
  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(radius);
  ball->SetThetaResolution(20);
  ball->SetPhiResolution(14);
  vtkNew<vtkGlyph3DMapper> mapper;
  mapper->SetInputData(body.frames);
  mapper->SetSourceConnection(ball->GetOutputPort());
  mapper->ScalarVisibilityOff();
  mapper->ScalingOff();
  mapper->OrientOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.85, 0.20, 0.15);
  actor->GetProperty()->SetSpecular(0.3);
  renderer.AddActor(actor);
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
    if (style.frames) add_frames(*in_front, body, 0.006 * box.GetDiagonalLength());
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
