#include "io/picture/canvas.hpp"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <cmath>

namespace fascia::io {
namespace {

constexpr int dots_per_inch = 72;  // a point is a pixel

void apply(const TextStyle& style, vtkTextProperty& look) {
  look.SetFontFamilyToArial();
  look.SetFontSize(style.size);
  look.SetBold(style.bold);
  look.SetItalic(false);
  look.SetShadow(false);
}

}  // namespace

Pixel measure(const std::string& text, const TextStyle& style) {
  vtkNew<vtkTextProperty> look;
  apply(style, *look);
  std::array<int, 4> box{};
  if (!vtkTextRenderer::GetInstance()->GetBoundingBox(look, text, box.data(), dots_per_inch)) return {};
  return {static_cast<double>(box[1] - box[0] + 1), static_cast<double>(box[3] - box[2] + 1)};
}

void Canvas::triangle(Pixel a, Pixel b, Pixel c, const Color& color) { shapes_.push_back({{a, b, c}, color}); }

void Canvas::rectangle(Pixel low, Pixel high, const Color& color) {
  triangle(low, {high.x, low.y}, high, color);
  triangle(low, high, {low.x, high.y}, color);
}

void Canvas::stroke(Pixel a, Pixel b, double width, const Color& color) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  if (!(length > 0)) return;
  const Pixel side{-0.5 * width * (b.y - a.y) / length, 0.5 * width * (b.x - a.x) / length};
  const Pixel p{a.x + side.x, a.y + side.y}, q{b.x + side.x, b.y + side.y};
  const Pixel r{b.x - side.x, b.y - side.y}, s{a.x - side.x, a.y - side.y};
  triangle(p, q, r, color);
  triangle(p, r, s, color);
}

void Canvas::text(Pixel at, const std::string& text, const TextStyle& style, const Color& color) {
  if (!text.empty()) labels_.push_back({at, text, style, color});
}

void Canvas::add_to(vtkRenderer& renderer) const {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> triangles;
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  for (const Shape& shape : shapes_) {
    triangles->InsertNextCell(3);
    for (const Pixel& corner : shape.corners)
      triangles->InsertCellPoint(points->InsertNextPoint(corner.x, corner.y, 0));
    for (const double part : shape.color) colors->InsertNextValue(static_cast<unsigned char>(std::lround(255 * part)));
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(triangles);
  data->GetCellData()->SetScalars(colors);
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(data);
  vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  renderer.AddActor2D(actor);
  for (const Label& label : labels_) {
    vtkNew<vtkTextActor> text;
    text->SetInput(label.text.c_str());
    vtkTextProperty* look = text->GetTextProperty();
    apply(label.style, *look);
    look->SetColor(label.color[0], label.color[1], label.color[2]);
    look->SetJustification(label.style.across == Anchor::left     ? VTK_TEXT_LEFT
                           : label.style.across == Anchor::center ? VTK_TEXT_CENTERED
                                                                  : VTK_TEXT_RIGHT);
    look->SetVerticalJustificationToCentered();
    text->SetPosition(label.at.x, label.at.y);
    renderer.AddActor2D(text);
  }
}

}  // namespace fascia::io
