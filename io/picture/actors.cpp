#include "io/picture/actors.hpp"

#include <vtkActor.h>
#include <vtkGlyph3DMapper.h>
#include <vtkNew.h>
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
  look->SetAmbient(0.4);
  look->SetDiffuse(0.65);
  look->SetSpecular(0.12);
  look->SetSpecularPower(25);
  look->BackfaceCullingOff();  // open sheets have two sides
  renderer.AddActor(actor);
}

/// A ball at each point.
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

}  // namespace

bool has_points(vtkPolyData* part) { return part->GetNumberOfPoints() > 0; }

void add_surface(vtkRenderer& renderer, const PictureBody& body, vtkLookupTable* colors) {
  if (!has_points(body.surface)) return;
  constexpr double crease = 35;  // degrees: sharper edges stay sharp
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(body.surface);
  normals->SetFeatureAngle(crease);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(normals->GetOutputPort());
  color(*mapper, colors, body.shown_on);
  mapper->SetResolveCoincidentTopologyToPolygonOffset();
  mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(2, 2);  // behind the lines of its edges
  add_actor(renderer, mapper);
}

void add_edges(vtkRenderer& renderer, const PictureBody& body) {
  if (!has_points(body.edges)) return;
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(body.edges);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetRepresentationToWireframe();
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetColor(0.05, 0.05, 0.08);
  const double faces = static_cast<double>(body.edges->GetNumberOfPolys());
  actor->GetProperty()->SetOpacity(std::clamp(0.32 - 0.05 * std::log10(1 + faces), 0.08, 0.25));
  actor->GetProperty()->SetLineWidth(1);
  renderer.AddActor(actor);
}

void add_lines(vtkRenderer& renderer, const PictureBody& body, vtkLookupTable* colors, double radius) {
  if (!has_points(body.lines)) return;
  constexpr int sides = 10;
  const ShownOn shown_on = body.shown_on == ShownOn::points ? ShownOn::points : ShownOn::nothing;
  vtkNew<vtkTubeFilter> tubes;
  tubes->SetInputData(body.lines);
  tubes->SetRadius(radius);
  tubes->SetNumberOfSides(sides);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(tubes->GetOutputPort());
  color(*mapper, colors, shown_on);
  add_actor(renderer, mapper);
  vtkNew<vtkGlyph3DMapper> joints;  // round ends and bends
  place_balls(*joints, body.lines, radius, sides, 6);
  color(*joints, colors, shown_on);
  joints->InterpolateScalarsBeforeMappingOff();  // each ball has one colour
  add_actor(renderer, joints);
}

void add_frames(vtkRenderer& renderer, const PictureBody& body, double radius) {
  if (!has_points(body.frames)) return;
  vtkNew<vtkGlyph3DMapper> mapper;
  place_balls(*mapper, body.frames, radius, 20, 14);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.85, 0.20, 0.15);
  actor->GetProperty()->SetSpecular(0.3);
  renderer.AddActor(actor);
}

}  // namespace fascia::io
