#include "app/extremes/cells.hpp"

#include "core/base/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <set>

namespace fascia::app {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

bool always(const Specimen&) { return true; }
bool in_dynamics(const Specimen& s) { return s.dynamic; }
bool of_cells(const Specimen& s) { return is_element(s.model) || s.model == BeamModel::shell; }
bool with_end_face(const Specimen& s) { return !is_thin(s.model); }
bool of_laws(const Specimen& s) {
  return !is_thin(s.model) && s.model != BeamModel::linear_tetrahedra && s.model != BeamModel::corotational_tetrahedra;
}
bool coupled(const Specimen& s) { return s.model == BeamModel::coupled; }

void act(Specimen& s, Action action, double amount) {
  s.action = action;
  s.amount = amount;
}

std::vector<Specimen> all_rows() {
  std::vector<Specimen> rows;
  rows.reserve(4 * kModelNames.size());
  for (std::size_t m = 0; m < kModelNames.size(); ++m)
    for (const bool dynamic : {false, true})
      for (const bool cg : {false, true}) {
        Specimen s;
        s.model = static_cast<BeamModel>(m);
        s.dynamic = dynamic;
        s.cg = cg;
        rows.push_back(s);
      }
  return rows;
}

ExtremeCell cell_of(const Specimen& s, const std::string& axis, const std::string& value) {
  const bool end_is_led = s.action == Action::stretch || s.action == Action::twist;
  ExtremeCell cell{row_of(s), axis, value, s.text(), s.theory(), s.young * s.section(), s.length};
  cell.is_borne = s.is_borne();
  cell.has_equilibrium = s.dynamic || s.held || end_is_led;
  return cell;
}

}  // namespace

std::string ExtremeAxis::text_of(double value) const {
  return unit.empty() ? fmt::format("{:g}", value) : fmt::format("{:g} {}", value, unit);
}

const std::vector<ExtremeAxis>& extreme_axes() {
  static const std::vector<ExtremeAxis> axes{
      {"Young's modulus", "Pa", {1, 1e2, 1e4, 1e6, 1e9, 1e12}, always, [](Specimen& s, double v) { s.young = v; }},
      {"Poisson's ratio", "", {0, 0.45, 0.49, 0.499, 0.4999}, always, [](Specimen& s, double v) { s.poisson = v; }},
      {"length", "m", {1e-4, 1e-2, 1, 1e2, 1e4}, always, [](Specimen& s, double v) { s.length = v; }},
      {"time step", "s", {1e-6, 1e-4, 1e-1, 1}, in_dynamics, [](Specimen& s, double v) { s.time_step = v; }},
      {"stiffness contrast", "", {1e2, 1e4, 1e6, 1e8}, always, [](Specimen& s, double v) { s.stiffness_contrast = v; }},
      {"density contrast", "", {1e2, 1e4, 1e6}, coupled, [](Specimen& s, double v) { s.density_contrast = v; }},
      {"slivers",
       "",
       {10, 1e2, 1e4, 1e6},
       of_cells,
       [](Specimen& s, double v) {
         s.taper = v;
         s.action = Action::weight;
       }},
      {"length to thickness", "", {2, 10, 1e2, 1e3, 1e4}, always, [](Specimen& s, double v) { s.slenderness = v; }},
      {"stretch", "", {0.2, 0.5, 0.8, 1.5, 2, 3}, always, [](Specimen& s, double v) { act(s, Action::stretch, v); }},
      {"neo-Hookean stretch",
       "",
       {0.2, 0.5, 0.8, 1.5, 2, 3},
       of_laws,
       [](Specimen& s, double v) {
         act(s, Action::stretch, v);
         s.neo_hookean = true;
       }},
      {"twist",
       "degree",
       {90, 180, 360, 720},
       always,
       [](Specimen& s, double v) { act(s, Action::twist, v * kDegree); }},
      {"pull", "E A", {1e-9, 1e-6, 1e-3, 0.1, 1, 10}, always, [](Specimen& s, double v) { act(s, Action::pull, v); }},
      {"compression",
       "Euler loads",
       {0.5, 0.9, 1.1, 2, 5, 10},
       always,
       [](Specimen& s, double v) { act(s, Action::compress, v); }},
      {"following pressure",
       "Euler loads",
       {0.5, 1.1, 2, 5, 10},
       with_end_face,
       [](Specimen& s, double v) { act(s, Action::push, v); }},
      {"no support", "", {1}, always, [](Specimen& s, double) { s.held = false; }},
  };
  return axes;
}

std::string row_of(const Specimen& s) {
  return fmt::format("{}, {}, {}", name_of(s.model), s.dynamic ? "dynamic" : "static", s.cg ? "cg" : "cholesky");
}

std::vector<ExtremeCell> map_cells() {
  std::vector<ExtremeCell> cells;
  for (const Specimen& row : all_rows()) {
    cells.push_back(cell_of(row, "base", "1"));
    for (const ExtremeAxis& axis : extreme_axes()) {
      if (!axis.applies(row)) continue;
      for (const double value : axis.values) {
        Specimen s = row;
        axis.set(s, value);
        cells.push_back(cell_of(s, axis.name, axis.text_of(value)));
      }
    }
  }
  return cells;
}

std::vector<ExtremeCell> reduced_cells() {
  std::vector<ExtremeCell> cells;
  const std::vector<Specimen> rows = all_rows();
  std::size_t turn = 0;
  for (std::size_t m = 0; m < kModelNames.size(); ++m)
    for (const ExtremeAxis& axis : extreme_axes())
      for (std::size_t i = 0; i < axis.values.size(); i += std::max<std::size_t>(1, axis.values.size() - 1)) {
        // The next of the model's four kinds of runs to which the axis applies.
        const auto row = [&](std::size_t k) { return rows[4 * m + k % 4]; };
        std::size_t k = turn;
        while (k < turn + 4 && !axis.applies(row(k))) ++k;
        if (k == turn + 4) continue;
        ++turn;
        Specimen s = row(k);
        axis.set(s, axis.values[i]);
        cells.push_back(cell_of(s, axis.name, axis.text_of(axis.values[i])));
      }
  return cells;
}

std::vector<ExtremeCell> pair_cells(int count, std::uint64_t seed) {
  std::vector<ExtremeCell> cells;
  const std::vector<Specimen> rows = all_rows();
  const std::vector<ExtremeAxis>& axes = extreme_axes();
  std::size_t all = 0;
  for (const Specimen& s : rows)
    for (const ExtremeAxis& a : axes)
      for (const ExtremeAxis& b : axes)
        if (&a != &b && a.applies(s) && b.applies(s)) all += a.values.size() * b.values.size();
  if (count > 0 && static_cast<std::size_t>(count) > all)
    throw InputError(
        fmt::format("extremes: --pairs {}: there are {} pairs of extremes; give that at most", count, all));
  std::set<std::string> names;
  std::mt19937_64 random(seed);
  const auto draw = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  while (cells.size() < static_cast<std::size_t>(count)) {
    Specimen s = rows[draw(rows.size())];
    const ExtremeAxis &a = axes[draw(axes.size())], &b = axes[draw(axes.size())];
    const double va = a.values[draw(a.values.size())], vb = b.values[draw(b.values.size())];
    if (&a == &b || !a.applies(s) || !b.applies(s)) continue;
    a.set(s, va);
    b.set(s, vb);
    ExtremeCell cell = cell_of(s, "pairs", fmt::format("{} {}, {} {}", a.name, a.text_of(va), b.name, b.text_of(vb)));
    if (names.insert(cell.name()).second) cells.push_back(std::move(cell));
  }
  return cells;
}

}  // namespace fascia::app
