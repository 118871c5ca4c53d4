#include "app/list.hpp"

#include "app/results/probes.hpp"
#include "app/run/run_scene.hpp"
#include "app/scene/document.hpp"
#include "app/scene/units.hpp"
#include "app/schema/schema.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// Empty where the scene has none or cannot be read.
std::string title_of(const fs::path& scene) {
  try {
    const Value document = parse_toml(io::read_file(scene));
    const Value* title = document.find("title");
    const std::string* text = title ? title->as_string() : nullptr;
    return text ? *text : "";
  } catch (const SyntaxError&) {
    return "";
  } catch (const InputError&) {
    return "";
  } catch (const FileError&) {
    return "";
  }
}

int width_of(const std::map<std::string, std::string>& lines) {
  std::size_t width = 0;
  for (const auto& [name, text] : lines) width = std::max(width, name.size());
  return static_cast<int>(width);
}

void list_scenes() {
  const fs::path folder = scenes_folder();
  std::map<std::string, std::string> titles;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".toml") titles[entry.path().filename().string()] = title_of(entry.path());
  fmt::print("{}:\n", folder.string());
  const int width = width_of(titles);
  for (const auto& [name, title] : titles) fmt::print("  {:{}}  {}\n", name, width, title);
}

/// Without the unit in brackets, which has a column of its own.
std::string meaning_of(std::string doc) {
  const std::size_t begin = doc.find(" ["), end = doc.find(']', begin);
  if (begin != std::string::npos && end != std::string::npos) doc.erase(begin, end + 1 - begin);
  return doc;
}

void list_quantities() {
  const Key probes = probes_schema();
  for (const Choice& c : probes.shape.items.front().find("quantity")->shape.choices)
    if (c.supported) fmt::print("{:17}  {:8}  {}\n", c.value, unit_of_quantity(c.value), meaning_of(c.doc));
}

void list_units() {
  fmt::print("A bare number has the unit of the first column; a text has its own, as in \"5 mm\".\n");
  fmt::print("Any unit of UDUNITS-2 is understood, among them:\n");
  for (const UnitExamples& u : unit_examples())
    fmt::print("{:7} {:23} {:15} {}\n", u.unit, u.noun, fmt::format("\"{}\"", u.example), u.others);
}

}  // namespace

/// Of the packages and of `cmake --install`; of a bundle, whose program may be started through the loader in its folder
/// lib; of a build in a checkout.
fs::path scenes_folder() {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path();
  std::vector<std::string> tried;
  for (const char* place : {"scenes", "../share/fascia/scenes", "../scenes", "../../scenes"}) {
    fs::path folder = (program / place).lexically_normal();
    tried.push_back(folder.string());
    if (fs::is_directory(folder)) return folder;
  }
  throw FileError(fmt::format("there are no scenes in {}; get them from the source or the package of fascia",
                              fmt::join(tried, ", ")));
}

std::vector<std::string> listed_things() { return {"scenes", "quantities", "units"}; }

int list_things(const std::string& what) {
  if (what == "scenes")
    list_scenes();
  else if (what == "quantities")
    list_quantities();
  else
    list_units();
  return kDone;
}

}  // namespace fascia::app
