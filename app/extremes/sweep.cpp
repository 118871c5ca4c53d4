#include "app/extremes/sweep.hpp"

#include "app/extremes/other_units.hpp"
#include "app/extremes/twin.hpp"
#include "app/reader/overrides.hpp"
#include "app/reader/parse.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

constexpr int kSweepSteps = 20;  ///< of a dynamic scene whose time step is swept

/// Cells lie elsewhere than the scene: its files are named from the root.
void name_files(Value& value, const fs::path& folder) {
  if (Table* members = value.as_table())
    for (Member& m : *members) {
      const std::string* file = m.key == "file" ? m.value.as_string() : nullptr;
      if (file != nullptr)
        m.value.data = fs::absolute(folder / *file).lexically_normal().string();
      else
        name_files(m.value, folder);
    }
  else if (Array* items = value.as_array())
    for (Value& item : *items) name_files(item, folder);
}

bool begins(std::string_view path, std::string_view with) { return path.substr(0, with.size()) == with; }
bool ends(std::string_view path, std::string_view with) {
  return path.size() >= with.size() && path.substr(path.size() - with.size()) == with;
}

/// A copy with those numbers multiplied that `chosen` says.
template <class Chosen>
std::string scaled(Value document, double factor, const Chosen& chosen) {
  scale_numbers(document, scene_schema(),
                [&](std::string_view unit, std::string_view path) { return chosen(unit, path) ? factor : 1.0; });
  return document_text(document);
}

class Sweep {
 public:
  Sweep(Value document, std::string row) : document_(std::move(document)), row_(std::move(row)) {
    add("base", "1", document_text(document_));
  }

  void stiffness() {
    for (const double k : {1e-6, 1e-4, 1e-2, 1e2, 1e4, 1e6})
      add("stiffness", times(k), scaled(document_, k, [](std::string_view unit, std::string_view path) {
            return unit == "Pa" && !begins(path, "loads") && !begins(path, "bodies")
                       ? true
                       : unit == "Pa" && begins(path, "bodies") && path.find(".material") != std::string_view::npos;
          }));
  }

  void poisson() {
    for (const double v : {0.0, 0.3, 0.45, 0.49, 0.499, 0.4999}) {
      Value document = document_;
      if (set_poisson(document, v)) add("Poisson's ratio", fmt::format("{:g}", v), document_text(document));
    }
  }

  /// Makes the experiment larger: materials stay; loads, gravity and times go with the lengths, so that strains stay.
  void size() {
    for (const double k : {1e-4, 1e-2, 1e2, 1e4}) {
      Value document = document_;
      if (change_units(document, {k * k * k, k, k})) add("size", times(k), document_text(document));
    }
  }

  void loads() {
    for (const double k : {1e-9, 1e-6, 1e-3, 0.1, 10.0, 100.0})
      add("loads", times(k), scaled(document_, k, [](std::string_view unit, std::string_view path) {
            if (begins(path, "world.gravity")) return true;
            const bool amount = unit == "N" || unit == "N m" || unit == "Pa" || unit == "N/m";
            return (begins(path, "loads") && amount) || ends(path, "fluid.pressure");
          }));
  }

  void time_step() {
    const Value* solver = document_.find("solver");
    const Value* kind = solver != nullptr ? solver->find("kind") : nullptr;
    const std::string* name = kind != nullptr ? kind->as_string() : nullptr;
    const Value* step = solver != nullptr ? solver->find("time_step") : nullptr;
    if (name == nullptr || *name == "static" || *name == "modes" || step == nullptr) return;
    for (const double v : {1e-6, 1e-4, 1e-2, 1e-1, 1.0}) {
      Value document = document_;
      Diagnostics none("");
      for (const char* key : {"duration", "steps"})
        if (solver->find(key) != nullptr) apply_override(document, fmt::format("solver.{}=", key), none);
      apply_override(document, fmt::format("solver.time_step={}", v), none);
      apply_override(document, fmt::format("solver.steps={}", kSweepSteps), none);
      add("time step", fmt::format("{:g} s", v), document_text(document));
    }
  }

  std::vector<ExtremeCell> take() { return std::move(cells_); }

 private:
  static std::string times(double k) { return fmt::format("x {:g}", k); }

  void add(const std::string& axis, const std::string& value, std::string text) {
    cells_.push_back({row_, axis, value, std::move(text), std::nullopt});
  }

  /// Sets it in all materials. @return false where there is none with one
  static bool set_poisson(Value& value, double poisson) {
    bool found = false;
    if (Table* members = value.as_table())
      for (Member& m : *members) {
        if (m.key == "poisson") {
          m.value.data = poisson;
          found = true;
        } else {
          found = set_poisson(m.value, poisson) || found;
        }
      }
    else if (Array* items = value.as_array())
      for (Value& item : *items) found = set_poisson(item, poisson) || found;
    return found;
  }

  Value document_;
  std::string row_;
  std::vector<ExtremeCell> cells_;
};

}  // namespace

std::vector<ExtremeCell> sweep_cells(const fs::path& path, const std::vector<std::string>& overrides) {
  const Scene scene = parse_scene_file(path, overrides);
  if (scene.probes.empty())
    throw InputError(
        fmt::format("{}: has no probe, by which runs could be compared; add one, for example [probes.all] "
                    "with body = \"{}\" and quantity = \"max_displacement\"",
                    path.string(), scene.bodies.front().name));
  if (scene.states_need())
    throw InputError(
        fmt::format("{}: states a need, which would choose other frames or cells at every value; run it "
                    "once, and sweep the chosen.toml of its result",
                    path.string()));
  if (scene.solver.budget)
    throw InputError(
        fmt::format("{}: gives steps a budget, which would end them before they are right; add --set "
                    "solver.budget=none",
                    path.string()));
  Diagnostics none(path.string());
  Value document = parse_document(io::read_file(path), none);
  for (const std::string& change : overrides) apply_override(document, change, none);
  name_files(document, path.parent_path());
  Sweep sweep(std::move(document), path.stem().string());
  sweep.stiffness();
  sweep.poisson();
  sweep.size();
  sweep.time_step();
  sweep.loads();
  return sweep.take();
}

}  // namespace fascia::app
