#include "app/extremes/specimen.hpp"

#include "core/physics/ellipticity.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace fascia::app {
namespace {

constexpr int kCells = 8;   ///< along the beam; 2 across
constexpr int kSteps = 10;  ///< of dynamics

/// Half the length of a thin slice around a plane, relative to the beam's length.
constexpr double kSlice = 1e-6;

/// Loads across what is pressed, relative to those that bend it by its length or buckle it.
constexpr double kAcross = 1e-3;

std::string point(double x, double y, double z) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", x, y, z); }

std::string box(double x0, double y0, double z0, double x1, double y1, double z1) {
  return fmt::format("box = {{ min = {}, max = {}", point(x0, y0, z0), point(x1, y1, z1));
}

/// All between two planes across the beam.
std::string slice(const Specimen& s, double from, double to) {
  const double l = s.length;
  return "{ " + box(from * l, -l, -l, to * l, l, l) + " } }";
}
/// A shell whose cells become slivers is a sector of a ring.
bool is_sector(const Specimen& s) { return s.model == BeamModel::shell && s.taper != 1; }
std::string near_end(const Specimen& s) { return is_sector(s) ? R"({ group = "outer" })" : slice(s, -kSlice, kSlice); }
std::string far_end(const Specimen& s) {
  return is_sector(s) ? R"({ group = "inner" })" : slice(s, 1 - kSlice, 1 + kSlice);
}

/// A sector of a ring about a place beyond the far end, of which the near end is as wide as the beam.
std::string sector(const Specimen& s) {
  const double inner = s.length / (s.taper - 1), outer = inner + s.length, half = 0.5 * s.width() / outer;
  return fmt::format(
      "{{ annulus = {{ center = {}, normal = [0, 0, 1], inner = {:.17g}, outer = {:.17g}, angle = [{:.17g}, {:.17g}], "
      "cells = [{}, 2] }} }}",
      point(outer, 0.5 * s.width(), 0), inner, outer, std::numbers::pi - half, std::numbers::pi + half, kCells);
}

/// Cuboid part of the beam; of elements one that grows thinner.
std::string solid_domain(const Specimen& s, double from, double to) {
  const double x0 = from * s.length, x1 = to * s.length, w = s.width(), h = s.thickness();
  const int along = static_cast<int>(std::lround(kCells * (to - from)));
  const std::string cells = fmt::format(", cells = [{}, 2, 2]", along);
  if (s.taper == 1 || !is_element(s.model))
    return "{ " + box(x0, 0, 0, x1, w, h) + (is_element(s.model) || from > 0 ? cells : "") + " } }";
  const double low = 0.5 * h * (1 - 1 / s.taper), high = h - low;
  return fmt::format("{{ block = {{ corners = [{}, {}, {}, {}, {}, {}, {}, {}]{} }} }}", point(x0, 0, 0),
                     point(x1, 0, low), point(x1, w, low), point(x0, w, 0), point(x0, 0, h), point(x1, 0, high),
                     point(x1, w, high), point(x0, w, h), cells);
}

/// The near half and the far one.
std::string both_materials(const Specimen& s) {
  return s.stiffness_contrast == 1
             ? R"("near")"
             : fmt::format(R"([{{ where = {}, use = "near" }}, {{ use = "far" }}])", slice(s, -1, 0.5));
}

std::string body_text(const std::string& name, const std::string& model, const std::string& domain,
                      const std::string& material, const std::string& more, double density) {
  return fmt::format("[bodies.{}]\nmodel = \"{}\"\ndomain = {}\ndensity = {:.17g}\nmaterial = {}\n{}\n", name, model,
                     domain, density, material, more);
}

std::string material_text(const Specimen& s, const char* name, double young) {
  return fmt::format("[materials.{}]\nyoung = {:.17g}\npoisson = {:.17g}\n{}", name, young, s.poisson,
                     s.neo_hookean ? "law = \"neo-hookean\"\n" : "");
}

/// Gravity across that moves the far end of a cantilever by about a part of the length.
std::string weight_text(const Specimen& s, double part) {
  const double l = s.length;
  return fmt::format("[world]\ngravity = {}\n",
                     point(0, 0, -part * 8 * s.young * s.second_moment() / (l * l * l * s.section() * s.density)));
}

std::string bodies_text(const Specimen& s) {
  const double l = s.length, w = s.width(), h = s.thickness();
  const std::string grid = fmt::format("frames = {{ grid = [{}, 3, 3] }}\n", kCells + 1);
  const auto whole = [&](const char* model, const std::string& more) {
    return body_text("beam", model, solid_domain(s, 0, 1), both_materials(s), more, s.density);
  };
  const auto surface = [&](const char* model, const std::string& more, const std::string& cells) {
    const std::string domain =
        is_sector(s) ? sector(s)
                     : fmt::format("{{ rectangle = {{ origin = [0, 0, 0], edge_u = {}, edge_v = {}{} }} }}",
                                   point(l, 0, 0), point(0, w, 0), cells);
    return body_text("beam", model, domain, both_materials(s), more + fmt::format("thickness = {:.17g}\n", h),
                     s.density);
  };
  switch (s.model) {
    case BeamModel::grid:
      return whole("meshless", grid);
    case BeamModel::scattered:
      return whole("meshless",
                   fmt::format("frames = {{ poisson_disk = {:.17g} }}\npoints = {{ poisson_disk = {:.17g} }}\n",
                               l / kCells, l / (2 * kCells)));
    case BeamModel::affine:
      return whole("meshless", fmt::format("frames = {{ grid = [{}, 3, 3], kind = \"affine\" }}\n", kCells + 1));
    case BeamModel::sheet:
      return surface("meshless", fmt::format("frames = {{ grid = [{}, 3] }}\n", kCells + 1), "");
    case BeamModel::line:
      return body_text("beam", "meshless", fmt::format("{{ line = {{ from = [0, 0, 0], to = {} }} }}", point(l, 0, 0)),
                       both_materials(s),
                       fmt::format("frames = {{ grid = [{}] }}\nradius = {:.17g}\n", 2 * kCells + 1, 0.5 * h),
                       s.density);
    case BeamModel::linear_tetrahedra:
      return whole("tetrahedra", "formulation = \"linear\"\n");
    case BeamModel::corotational_tetrahedra:
      return whole("tetrahedra", "formulation = \"corotational\"\n");
    case BeamModel::tetrahedra:
      return whole("tetrahedra", "");
    case BeamModel::quadratic_tetrahedra:
      return whole("tetrahedra", "order = 2\n");
    case BeamModel::hexahedra:
      return whole("hexahedra", "");
    case BeamModel::shell:
      return surface("shell", "", fmt::format(", cells = [{}, 2]", kCells));
    case BeamModel::coupled:
      return body_text("beam", "tetrahedra", solid_domain(s, 0.5, 1),
                       s.stiffness_contrast == 1 ? R"("near")" : R"("far")", "", s.density * s.density_contrast) +
             body_text("root", "meshless", solid_domain(s, 0, 0.5), R"("near")",
                       fmt::format("frames = {{ grid = [{}, 3, 3] }}\n", kCells / 2 + 1), s.density) +
             fmt::format("[couplings.joint]\nkind = \"embed\"\nbody = \"beam\"\nwhere = {}\nto = \"root\"\n",
                         slice(s, 0.5 - kSlice, 0.5 + kSlice));
  }
  return "";
}

std::string force_text(const Specimen& s, double along, double down) {
  return fmt::format("[[loads]]\nbody = \"beam\"\nwhere = {}\ntotal_force = {}\n", far_end(s), point(along, 0, -down));
}

std::string action_text(const Specimen& s) {
  const double l = s.length, ei = s.young * s.second_moment();
  const double euler = std::numbers::pi * std::numbers::pi * ei / (4 * l * l);
  const auto moved = [&](const std::string& motion) {
    return fmt::format("[[constraints]]\nbody = \"beam\"\nwhere = {}\nmove = {{ {} }}\n{}", far_end(s), motion,
                       s.dynamic ? fmt::format("over = {:.17g}\n", kSteps * s.time_step) : std::string());
  };
  switch (s.action) {
    case Action::bend:
      return force_text(s, 0, s.amount * 3 * ei / (l * l));
    case Action::weight:
      return weight_text(s, s.amount);
    case Action::pull:
      return force_text(s, s.amount * s.young * s.section(), 0);
    case Action::stretch:
      return moved("translate = " + point((s.amount - 1) * l, 0, 0)) + (s.amount < 1 ? weight_text(s, kAcross) : "");
    case Action::twist:
      return moved(fmt::format("rotate = {{ axis = [1, 0, 0], angle = {:.17g}, center = {} }}", s.amount,
                               is_thin(s.model) ? point(0, s.model == BeamModel::line ? 0 : 0.5 * s.width(), 0)
                                                : point(0, 0.5 * s.width(), 0.5 * s.thickness())));
    case Action::compress:
      return force_text(s, -s.amount * euler, kAcross * s.amount * euler);
    case Action::push:
      return fmt::format("[[loads]]\nbody = \"beam\"\nwhere = {}\npressure = {:.17g}\n", far_end(s),
                         s.amount * euler / s.section()) +
             force_text(s, 0, kAcross * s.amount * euler);
  }
  return "";
}

}  // namespace

std::string name_of(BeamModel model) { return kModelNames[static_cast<std::size_t>(model)]; }

bool is_element(BeamModel model) {
  return model == BeamModel::linear_tetrahedra || model == BeamModel::corotational_tetrahedra ||
         model == BeamModel::tetrahedra || model == BeamModel::quadratic_tetrahedra || model == BeamModel::hexahedra;
}

bool is_thin(BeamModel model) {
  return model == BeamModel::sheet || model == BeamModel::line || model == BeamModel::shell;
}

double Specimen::thickness() const {
  const bool column = action == Action::compress || action == Action::push;
  const double usual = model == BeamModel::sheet || model == BeamModel::shell ? 40 : column ? 20 : 4;
  return length / (slenderness > 0 ? slenderness : usual);
}

double Specimen::width() const { return (is_thin(model) ? 0.25 : 0.3) * length; }

double Specimen::section() const {
  const double h = thickness();
  return model == BeamModel::line ? 0.25 * std::numbers::pi * h * h : width() * h;
}

double Specimen::second_moment() const {
  const double h = thickness();
  return model == BeamModel::line ? std::numbers::pi * std::pow(h, 4) / 64 : width() * std::pow(h, 3) / 12;
}

std::string Specimen::text() const {
  std::string text = material_text(*this, "near", young);
  if (stiffness_contrast != 1) text += material_text(*this, "far", young * stiffness_contrast);
  text += bodies_text(*this);
  if (held)
    text += fmt::format("[[constraints]]\nbody = \"{}\"\nwhere = {}\nfix = \"all\"\n",
                        model == BeamModel::coupled ? "root" : "beam", near_end(*this));
  text += action_text(*this);
  text += "[solver]\nbackend = \"cpu\"\n";
  text += dynamic ? fmt::format("kind = \"implicit-euler\"\ntime_step = {:.17g}\nsteps = {}\n", time_step, kSteps)
                  : std::string("kind = \"static\"\n");
  text += fmt::format("linear = {{ kind = \"{}\" }}\n", cg ? "cg" : "cholesky");
  const double y = model == BeamModel::line ? 0 : 0.5 * width(), z = is_thin(model) ? 0 : 0.5 * thickness();
  const auto probe = [&](const char* name, const char* quantity, const std::string& where) {
    text += fmt::format("[probes.{}]\nbody = \"beam\"\nquantity = \"{}\"\n{}", name, quantity, where);
  };
  probe("tip", "displacement", "at = " + point(length, y, z) + "\n");
  probe("middle", "displacement", "at = " + point(0.625 * length, y, z) + "\n");
  probe("largest", "max_displacement", "");
  // The support may feel next to nothing in the first steps: errors of forces are told relative to what acts.
  if (action != Action::weight) probe("acting", "force", "where = " + far_end(*this) + "\n");
  if (held)
    text += fmt::format("[probes.support]\nbody = \"{}\"\nquantity = \"force\"\nwhere = {}\n",
                        model == BeamModel::coupled ? "root" : "beam", near_end(*this));
  // Fields are not looked at, and what is extreme is meant.
  return text + "[output]\nfields = [\"displacement\"]\n";
}

bool Specimen::is_borne() const {
  const bool corotational = model == BeamModel::corotational_tetrahedra;
  if (neo_hookean || model == BeamModel::linear_tetrahedra) return true;
  const Lame lame = Lame::from_young(young, poisson);
  if (action == Action::twist && !is_thin(model) && !corotational) {
    const double shear = amount * 0.5 * std::hypot(width(), thickness()) / length, height = 1 / std::hypot(1, shear);
    Mat3d F = Mat3d::diagonal(1);
    F(0, 1) = shear * height;
    F(1, 1) = height;
    return is_strongly_elliptic(lame, F);
  }
  if (action != Action::stretch && action != Action::pull) return true;
  double along = amount;
  if (action == Action::pull) {
    along = 1 + amount;
    // λ (λ² − 1) / 2 = amount, by Newton's method from above.
    for (int k = 0; k < 60 && !corotational; ++k)
      along -= (0.5 * along * (along * along - 1) - amount) / (1.5 * along * along - 0.5);
  }
  const double left = 1 - poisson * (corotational ? along - 1 : along * along - 1);  // of the section
  if (left <= 0 || corotational) return left > 0;
  Mat3d F = Mat3d::diagonal(std::sqrt(left));
  F(0, 0) = along;
  return is_strongly_elliptic(lame, F);
}

std::optional<double> Specimen::theory() const {
  if (dynamic || !held || stiffness_contrast != 1 || taper != 1) return std::nullopt;
  const double shear = young / (2 * (1 + poisson));
  if (action == Action::bend && amount <= 0.01) {
    const double force = amount * 3 * young * second_moment() / (length * length);
    return amount * length + force * length / (shear * section() * 5 / 6);
  }
  if (action == Action::pull && amount <= 1e-3) return amount * length;
  return std::nullopt;
}

}  // namespace fascia::app
