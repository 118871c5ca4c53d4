#include "io/picture/actors.hpp"

#include "io/picture/annotations.hpp"
#include "io/picture/outline.hpp"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkCubeSource.h>
#include <vtkGlyph3DMapper.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>
#include <vtkTubeFilter.h>

#include <algorithm>
#include <cmath>

namespace fascia::io {
namespace {

void color(vtkMapper& mapper, vtkLookupTable* colors, ShownOn shown_on) {
  const bool visible = colors && shown_on != ShownOn::nothing;
  mapper.SetScalarVisibility(visible);
  if (!visible) return;
  mapper.SetLookupTable(colors);
  mapper.UseLookupTableScalarRangeOn();
  if (shown_on == ShownOn::cells) {
    mapper.SetScalarModeToUseCellData();
    return;
  }
  mapper.SetScalarModeToUsePointData();
  mapper.InterpolateScalarsBeforeMappingOn();
}

/// Adds what is coloured, in tissue's look.
void add_actor(vtkRenderer& renderer, vtkMapper* mapper) {
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* look = actor->GetProperty();
  look->SetColor(0.80, 0.55, 0.50);
  look->SetAmbient(0.55);  // so that shade hardly changes the colours of the legend
  look->SetDiffuse(0.5);
  look->SetSpecular(0.08);
  look->SetSpecularPower(25);
  look->BackfaceCullingOff();  // open sheets have two sides
  renderer.AddActor(actor);
}

/// A ball at each point, of one colour or that of its point.
void place_balls(vtkGlyph3DMapper& mapper, vtkPolyData* points, double radius, int around, int along) {
  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(radius);
  ball->SetThetaResolution(around);
  ball->SetPhiResolution(along);
  mapper.SetInputData(points);
  mapper.SetSourceConnection(ball->GetOutputPort());
  mapper.ScalingOff();
  mapper.OrientOff();
}

void add_glyphs(vtkRenderer& renderer, vtkGlyph3DMapper& mapper, const Color& color, double specular) {
  mapper.ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(&mapper);
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetProperty()->SetAmbient(0.35);
  actor->GetProperty()->SetDiffuse(0.7);
  actor->GetProperty()->SetSpecular(specular);
  renderer.AddActor(actor);
}

/// @param lift  towards the eye, which moves nothing in the picture, so that faces on the lines hide nothing of them
vtkActor* add_strokes(vtkRenderer& renderer, vtkPolyData* lines, const Color& color, double width, double lift) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(lines);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->SetPosition(0, 0, lift);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetProperty()->SetLineWidth(static_cast<float>(width));
  renderer.AddActor(actor);
  return actor;
}

vtkSmartPointer<vtkPolyData> points_at(const std::vector<Vec3d>& places, const Placing& placing) {
  vtkNew<vtkPoints> points;
  for (const Vec3d& x : places) points->InsertNextPoint(placing.of(x).v);
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  return data;
}

/// Cubes along the axes of the bodies.
void add_cubes(vtkRenderer& renderer, const std::vector<Vec3d>& places, const Placing& placing, double edge) {
  if (places.empty()) return;
  vtkNew<vtkCubeSource> cube;
  cube->SetXLength(edge);
  cube->SetYLength(edge);
  cube->SetZLength(edge);
  cube->Update();
  const vtkSmartPointer<vtkPolyData> turned = Placing{placing.view}.of(cube->GetOutput());
  turned->GetPointData()->SetNormals(nullptr);
  vtkNew<vtkGlyph3DMapper> mapper;
  mapper->SetInputData(points_at(places, placing));
  mapper->SetSourceData(turned);
  mapper->ScalingOff();
  mapper->OrientOff();
  add_glyphs(renderer, *mapper, mark_color, 0);
}

}  // namespace

bool has_points(vtkPolyData* part) { return part->GetNumberOfPoints() > 0; }

void add_surface(vtkRenderer& renderer, const PictureBody& body, const Placing& placing, vtkLookupTable* colors) {
  if (!has_points(body.surface)) return;
  constexpr double crease = 35;  // degrees: sharper edges stay sharp
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(placing.of(body.surface));
  normals->SetFeatureAngle(crease);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(normals->GetOutputPort());
  color(*mapper, colors, body.shown_on);
  add_actor(renderer, mapper);
}

void add_edges(vtkRenderer& renderer, const PictureBody& body, const Placing& placing, const Thickness& thickness) {
  if (!has_points(body.edges)) return;
  constexpr double steepest = 6;  // faces whose depth grows by more in a pixel may hide parts of lines
  vtkActor* actor = add_strokes(renderer, placing.of(body.edges), {0.05, 0.05, 0.08}, thickness.stroke,
                                steepest * thickness.pixel / placing.length);
  const auto edges = static_cast<double>(body.edges->GetNumberOfLines());
  actor->GetProperty()->SetOpacity(std::clamp(0.55 - 0.09 * std::log10(1 + edges), 0.12, 0.4));
}

void add_lines(vtkRenderer& renderer, const PictureBody& body, const Placing& placing, vtkLookupTable* colors,
               const Thickness& thickness) {
  if (!has_points(body.lines)) return;
  constexpr int sides = 12;
  const ShownOn shown_on = body.shown_on == ShownOn::points ? ShownOn::points : ShownOn::nothing;
  const double radius = thickness.tube / placing.length;
  const vtkSmartPointer<vtkPolyData> lines = placing.of(body.lines);
  vtkNew<vtkTubeFilter> tubes;
  tubes->SetInputData(lines);
  tubes->SetRadius(radius);
  tubes->SetNumberOfSides(sides);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(tubes->GetOutputPort());
  color(*mapper, colors, shown_on);
  add_actor(renderer, mapper);
  vtkNew<vtkGlyph3DMapper> joints;  // round ends and bends
  place_balls(*joints, lines, radius, sides, 6);
  color(*joints, colors, shown_on);
  joints->InterpolateScalarsBeforeMappingOff();  // each ball has one colour
  add_actor(renderer, joints);
}

void add_frames(vtkRenderer& renderer, const PictureBody& body, const Placing& placing, const Thickness& thickness) {
  if (!has_points(body.frames)) return;
  vtkNew<vtkGlyph3DMapper> mapper;
  place_balls(*mapper, placing.of(body.frames), thickness.ball / placing.length, 20, 14);
  add_glyphs(renderer, *mapper, frame_color, 0.3);
}

void add_rest(vtkRenderer& renderer, const PictureBody& body, const Placing& placing, const Thickness& thickness) {
  constexpr double behind = 3;  // pixels: what did not move hides its outline
  const vtkSmartPointer<vtkPolyData> outline = outline_of(*body.rest_surface, placing.view.toward);
  for (const vtkSmartPointer<vtkPolyData>& part : {outline, body.rest_lines})
    if (has_points(part))
      add_strokes(renderer, placing.of(part), rest_color, 1.4 * thickness.stroke,
                  -behind * thickness.pixel / placing.length);
}

void add_marks(vtkRenderer& renderer, const Marks& marks, const Placing& placing, const Thickness& thickness) {
  constexpr double apart = 2.5;  // edges of a cube
  const double edge = thickness.mark / placing.length;
  std::vector<Vec3d> cubes = thinned(marks.held, apart * thickness.mark);
  const std::vector<Vec3d> balls = thinned(marks.held_in_part, apart * thickness.mark);
  vtkNew<vtkPoints> ends;
  vtkNew<vtkCellArray> springs;
  for (const auto& spring : marks.springs) {
    springs->InsertNextCell(2);
    for (const Vec3d& x : spring) springs->InsertCellPoint(ends->InsertNextPoint(placing.of(x).v));
    cubes.push_back(spring[1]);
  }
  add_cubes(renderer, thinned(cubes, apart * thickness.mark), placing, edge);
  if (!balls.empty()) {
    vtkNew<vtkGlyph3DMapper> mapper;
    place_balls(*mapper, points_at(balls, placing), 0.55 * edge, 16, 12);
    add_glyphs(renderer, *mapper, mark_color, 0);
  }
  vtkNew<vtkPolyData> lines;
  lines->SetPoints(ends);
  lines->SetLines(springs);
  if (!has_points(lines)) return;
  constexpr double few = 12;  // springs that are drawn in full
  vtkActor* actor = add_strokes(renderer, lines, spring_color, 1.3 * thickness.stroke, 0);
  actor->GetProperty()->SetOpacity(std::clamp(std::sqrt(few / static_cast<double>(marks.springs.size())), 0.35, 1.0));
}

}  // namespace fascia::io
