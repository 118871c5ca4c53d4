#include "io/picture/picture.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "io/picture/actors.hpp"
#include "io/picture/annotations.hpp"
#include "io/picture/color_map.hpp"
#include "io/picture/layout.hpp"
#include "io/picture/legend.hpp"
#include "io/picture/values.hpp"
#include "io/picture/wrapping.hpp"
#include "io/vtk_errors.hpp"

#include <vtkCamera.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace fascia::io {
namespace {

constexpr double line_height = 1.45;           // of texts, times the font
constexpr std::array<int, 2> least{160, 120};  // pixels of a picture with texts

/// All that is coloured, with supports and springs; the frames where nothing is.
Extent extent_of(const PictureState& state, const View& view) {
  Extent extent, frames;
  for (const PictureBody& body : state.bodies) {
    extent.add(extent_of(body.surface, view));
    extent.add(extent_of(body.lines, view));
    frames.add(extent_of(body.frames, view));
  }
  if (extent.empty()) extent = frames;
  for (const auto& spring : state.marks.springs)
    for (const Vec3d& x : spring) extent.add(view.of(x));
  for (const auto* places : {&state.marks.held, &state.marks.held_in_part})
    for (const Vec3d& x : *places) extent.add(view.of(x));
  return extent;
}

/// How the bodies of all states lie in a picture.
struct Subject {
  Extent extent;
  bool rest = false;  ///< it lies elsewhere, yet not so far that the bodies would become small
};

Subject subject_of(const std::vector<PictureState>& states, const View& view, bool rest) {
  constexpr double seen = 0.006, far = 1.8;  // of the extent's diagonal
  Subject subject;
  Extent at_rest;
  double moved = 0;
  for (const PictureState& state : states) {
    subject.extent.add(extent_of(state, view));
    for (const PictureBody& body : state.bodies) {
      if (!body.rest) continue;
      at_rest.add(extent_of(body.rest_surface, view));
      at_rest.add(extent_of(body.rest_lines, view));
      for (vtkIdType p = 0; p < body.rest->GetNumberOfPoints(); ++p) {
        Vec3d now, then;
        body.now->GetPoint(p, now.v);
        body.rest->GetPoint(p, then.v);
        moved = std::max(moved, norm(now - then));
      }
    }
  }
  const double size = norm(subject.extent.size());
  Extent both = subject.extent;
  both.add(at_rest);
  subject.rest = rest && !at_rest.empty() && moved > seen * size && norm(both.size()) < far * size;
  if (subject.rest) subject.extent = both;
  if (!(norm(subject.extent.size()) > 0)) {  // a single point: room around it, in its own scale
    const double distance = norm(subject.extent.low), room = distance > 0 ? 0.01 * distance : 1;
    subject.extent.low -= Vec3d{{room, room, room}};
    subject.extent.high += Vec3d{{room, room, room}};
  }
  return subject;
}

/// The picture with what stands around the bodies.
class Figure {
 public:
  Figure(const std::vector<PictureState>& states, const PictureStyle& style)
      : states_(states),
        style_(style),
        font_(font_of(style.size)),
        view_(view_along(style.view, style.up)),
        subject_(subject_of(states, view_, style.rest)) {
    window_->SetOffScreenRendering(true);
    window_->SetMultiSamples(8);
    window_->SetDPI(72);
    window_->SetSize(style.size[0], style.size[1]);
    window_->SetNumberOfLayers(4);
    add_layer(0, nullptr, 1);  // white where nothing else is
    if (!style.field.empty()) {
      scale_ = scale_of(states, style);
      const double above = scale_.low < scale_.high ? scale_.high : scale_.low + std::max(1.0, std::abs(scale_.low));
      colors_ = perceptual_colors(scale_.low, above);
    }
    scene_ = {{0, 0}, {static_cast<double>(style.size[0]), static_cast<double>(style.size[1])}};
    const bool texts = style.size[0] >= least[0] && style.size[1] >= least[1];
    if (texts) {
      add_title();
      add_legend();
      scene_.low.y += 4.4 * font_;
    }
    add_scene(texts);
    if (texts) add_footer();
  }

  vtkRenderWindow& window() { return *window_; }

 private:
  void add_title() {
    const TextStyle bold{static_cast<int>(1.15 * font_), true};
    const auto width_of = [&](const std::string& text) { return measure(text, bold).x; };
    double y = scene_.high.y - 0.5 * font_;
    for (const std::string& line : wrapped(style_.title, width_of, scene_.width() - 2 * font_, 2)) {
      canvas_.text({1.0 * font_, y - 0.5 * line_height * bold.size}, line, bold, ink);
      y -= line_height * bold.size;
    }
    if (states_.size() == 1 && !states_[0].label.empty()) {
      canvas_.text({1.0 * font_, y - 0.5 * line_height * font_}, states_[0].label, {font_}, ink);
      y -= line_height * font_;
    }
    scene_.high.y = y - 0.5 * font_;
  }

  void add_legend() {
    if (!colors_) return;
    constexpr double part = 0.62;  // of the scene's height
    const double widest = 0.24 * scene_.width();
    const double height = std::min(std::max(part * scene_.height(), 12.0 * font_), scene_.height() - 1.2 * font_);
    const Legend legend(scale_, font_, height, widest);
    scene_.high.x -= legend.width() + 2.0 * font_;
    legend.draw(canvas_, {scene_.high.x + 1.0 * font_, 0.5 * (scene_.low.y + scene_.high.y - height)}, *colors_);
  }

  void add_scene(bool texts) {
    const Vec3d size = subject_.extent.size();
    const double largest = norm(size), least_side = 1e-3 * largest;
    const double label = texts && states_.size() > 1 ? line_height * font_ : 0;
    const std::vector<Area> tiles =
        tiles_of(scene_, states_.size(), std::max(size[0], least_side), std::max(size[1], least_side), label);
    const double margin = 1.0 * font_;
    metre_ = std::min((tiles[0].width() - 2 * margin) / std::max(size[0], least_side),
                      (tiles[0].height() - label - margin) / std::max(size[1], least_side));
    const Placing placing{view_, (subject_.extent.low + subject_.extent.high) * 0.5, largest};
    const Thickness thickness{0.0035 * largest, 0.006 * largest, (states_.size() > 1 ? 0.4 : 0.55) * font_ / metre_,
                              1 / metre_, std::max(1.0, font_ / 18.0)};
    for (std::size_t i = 0; i < states_.size(); ++i) {
      Area tile = tiles[i];
      tile.high.y -= label;
      if (label > 0)
        canvas_.text({0.5 * (tile.low.x + tile.high.x), tile.high.y + 0.5 * label}, states_[i].label,
                     {font_, false, Anchor::center}, ink);
      add_state(states_[i], tile, placing, thickness);
    }
  }

  void add_state(const PictureState& state, const Area& tile, const Placing& placing, const Thickness& thickness) {
    vtkRenderer& bodies = add_layer(1, &tile, placing.length);
    vtkRenderer& in_front = add_layer(2, &tile, placing.length);  // the surface hides nothing of it
    for (const PictureBody& body : state.bodies) {
      add_surface(bodies, body, placing, colors_);
      add_edges(bodies, body, placing, thickness);
      add_lines(bodies, body, placing, colors_, thickness);
      if (subject_.rest) add_rest(bodies, body, placing, thickness);
      if (style_.frames) add_frames(in_front, body, placing, thickness);
    }
    add_marks(bodies, state.marks, placing, thickness);
  }

  void add_footer() {
    const double radius = 2.1 * font_;
    draw_axes(canvas_, {0.6 * font_ + radius, 0.4 * font_ + radius}, radius, font_, view_);
    const double left = 5.8 * font_, y = 1.3 * font_, right = scene_.high.x - font_;
    const ScaleBar bar = scale_bar(metre_, std::min(0.22 * scene_.width(), right - left));
    draw_scale_bar(canvas_, {left, y}, font_, bar);
    const double text = measure(bar.text, {font_}).x,
                 key = left + std::max(bar.width, 0.5 * (bar.width + text)) + 2.0 * font_;
    draw_key(canvas_, {key, y}, right - key, font_, signs());
    canvas_.add_to(add_layer(3, nullptr, 1));
  }

  std::vector<Sign> signs() const {
    const auto any = [&](auto member) {
      return std::any_of(states_.begin(), states_.end(),
                         [&](const PictureState& s) { return !(s.marks.*member).empty(); });
    };
    std::vector<Sign> signs;
    if (subject_.rest) signs.push_back(Sign::rest);
    if (any(&Marks::held)) signs.push_back(Sign::support);
    if (any(&Marks::held_in_part)) signs.push_back(Sign::partial_support);
    if (any(&Marks::springs)) signs.push_back(Sign::spring);
    if (style_.frames) signs.push_back(Sign::frame);
    return signs;
  }

  /// @param area  null: the whole picture, in pixels
  vtkRenderer& add_layer(int layer, const Area* area, double length) {
    vtkNew<vtkRenderer> renderer;
    renderer->SetLayer(layer);
    renderer->SetBackground(1, 1, 1);
    if (area) {
      const double w = style_.size[0], h = style_.size[1];
      renderer->SetViewport(area->low.x / w, area->low.y / h, area->high.x / w, area->high.y / h);
      vtkCamera* camera = renderer->GetActiveCamera();
      camera->ParallelProjectionOn();
      camera->SetFocalPoint(0, 0, 0);
      camera->SetPosition(0, 0, 3);
      camera->SetViewUp(0, 1, 0);
      camera->SetClippingRange(1, 5);
      camera->SetParallelScale(0.5 * area->height() / metre_ / length);
      vtkNew<vtkLight> light;
      light->SetLightTypeToCameraLight();
      light->SetPosition(-0.2, 0.3, 1);
      light->SetFocalPoint(0, 0, 0);
      renderer->AddLight(light);
    }
    window_->AddRenderer(renderer);
    return *renderer;
  }

  const std::vector<PictureState>& states_;
  const PictureStyle& style_;
  int font_;
  View view_;
  Subject subject_;
  vtkNew<vtkRenderWindow> window_;
  vtkSmartPointer<vtkLookupTable> colors_;
  ColorScale scale_;
  Canvas canvas_;
  Area scene_;        ///< for the bodies
  double metre_ = 1;  ///< in the picture [pixels]
};

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

void render_picture(std::vector<PictureState> states, const PictureStyle& style, const std::filesystem::path& png) {
  const bool anything = std::any_of(states.begin(), states.end(), [&](const PictureState& state) {
    return std::any_of(state.bodies.begin(), state.bodies.end(), [&](const PictureBody& body) {
      return has_points(body.surface) || has_points(body.lines) || (style.frames && has_points(body.frames));
    });
  });
  if (!anything) throw InputError(png.string() + ": the results have no volume cells, triangles or lines to show");
  if (style.relative)
    for (PictureState& state : states) make_relative(state);
  VtkErrors errors;
  Figure figure(states, style);
  figure.window().Render();
  if (!errors.first().empty()) throw FileError(png.string() + ": cannot be rendered: " + errors.first());
  write_png(figure.window(), png);
}

}  // namespace fascia::io
