#include "core/base/errors.hpp"
#include "io/mesh/text_numbers.hpp"
#include "io/picture/display.hpp"
#include "io/picture/picture.hpp"
#include "io/quantity.hpp"

#include <CLI/CLI.hpp>

#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <utility>

namespace {

using fascia::InputError;
using fascia::io::PictureBody;
using fascia::io::PictureDescription;
using fascia::io::PictureState;

/// As many numbers as asked for, "x,y,z"; none where the text is something else.
std::optional<std::vector<double>> numbers(const std::string& text, std::size_t count) {
  std::vector<double> result;
  std::size_t begin = 0;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',', begin);
    more = comma != std::string::npos;
    const auto value = fascia::io::to_number(std::string_view(text).substr(begin, more ? comma - begin : comma));
    if (!value) return std::nullopt;
    result.push_back(*value);
    begin = comma + 1;
  }
  return result.size() == count ? std::optional(result) : std::nullopt;
}

/// Three numbers "x,y,z" that are not all zero.
fascia::Vec3d direction(const std::string& option, const std::string& text) {
  const auto v = numbers(text, 3);
  if (!v || *v == std::vector<double>(3))
    throw InputError(option + ": \"" + text + "\" must be three numbers x,y,z, not all zero");
  return {{(*v)[0], (*v)[1], (*v)[2]}};
}

/// "a,b", the first below the second.
std::array<double, 2> range(const std::string& text) {
  const auto ends = numbers(text, 2);
  if (!ends || !((*ends)[0] < (*ends)[1]))
    throw InputError("--range: \"" + text +
                     "\" must be two numbers a,b in SI units of the field, the first below the "
                     "second");
  return {(*ends)[0], (*ends)[1]};
}

/// "WxH", each from 16 to 16384.
std::array<int, 2> size(const std::string& text) {
  const std::size_t cross = text.find('x');
  const auto width = fascia::io::to_integer(std::string_view(text).substr(0, cross));
  const auto height =
      fascia::io::to_integer(cross == std::string::npos ? "" : std::string_view(text).substr(cross + 1));
  const auto fits = [](const std::optional<std::int64_t>& n) { return n && *n >= 16 && *n <= 16384; };
  if (!fits(width) || !fits(height))
    throw InputError("--size: \"" + text + "\" must be WIDTHxHEIGHT in pixels, each from 16 to 16384");
  return {static_cast<int>(*width), static_cast<int>(*height)};
}

/// A last file that is no picture is a result, and would be lost.
void check_picture_name(const std::string& file) {
  if (std::filesystem::path(file).extension() != ".png")
    throw InputError(file + ": the last file is the picture to write; must end in .png");
}

/// The bodies of each state; all in one where not each is wanted for itself.
std::vector<PictureState> states_of(std::vector<PictureBody> bodies, const PictureDescription& description, bool each) {
  std::map<int, PictureState> states;
  for (PictureBody& body : bodies) {
    const int state = each ? body.state : 0;
    states[state].label = state_label(description, body.state);
    states[state].bodies.push_back(std::move(body));
  }
  std::vector<PictureState> result;
  for (auto& [number, state] : states) {
    state.marks = find_marks(description, state.bodies);
    result.push_back(std::move(state));
  }
  return result;
}

int run(int argc, char** argv) {
  std::vector<std::string> files;
  std::string view = "1,1,1", up, pixels = "1200x800", ends;
  std::optional<std::string> title, label;
  bool sheet = false, no_rest = false, no_marks = false;
  fascia::io::PictureStyle style;
  CLI::App app{"Renders results of fascia: fascia-picture RESULT.vtu... OUT.png"};
  app.add_option("files", files, "results (.vtu), then the picture (.png)")->required()->expected(2, 1 << 20);
  app.add_option("--view", view, "direction from the bodies to the eye, x,y,z")->capture_default_str();
  app.add_option("--up", up,
                 "direction that points up in the picture, x,y,z (default: the scene's; without one z, or y where one "
                 "looks within 45 degrees of the z axis)");
  app.add_option("--size", pixels, "width and height in pixels")->capture_default_str();
  app.add_option("--field", style.field, "point or cell field that colours the surface (magnitude of vectors)");
  app.add_option(
      "--range", ends,
      "values of the first and the last colour, a,b, in SI units; of modes, whose amplitude is arbitrary, in parts of "
      "the largest (default: those shown)");
  app.add_option("--title", title, "text above the picture (default: the scene's title)");
  app.add_option("--label", label, "text below the title (default: the time, load factor, or mode)");
  app.add_flag("--sheet", sheet, "each state that the files belong to for itself, side by side and alike");
  app.add_flag("--frames", style.frames, "show the frames as balls in front of the surface");
  app.add_flag("--no-rest", no_rest, "leave out the outline at rest");
  app.add_flag("--no-marks", no_marks, "leave out supports and springs");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  check_picture_name(files.back());
  style.view = direction("--view", view);
  style.size = size(pixels);
  style.rest = !no_rest;
  if (!ends.empty()) style.range = range(ends);
  const std::filesystem::path directory = std::filesystem::path(files.front()).parent_path();
  PictureDescription description = fascia::io::read_description(directory);
  if (no_marks) description.supports.clear();
  if (no_marks) description.springs.clear();
  style.up = up.empty() ? description.up : direction("--up", up);
  style.title = title.value_or(description.title);
  // A mode has no amplitude: what follows from its displacement is known up to a factor.
  const bool of_mode = description.kind == fascia::io::StateKind::frequency;
  style.relative = of_mode && fascia::io::name_of_field(style.field).of_motion;

  const fascia::io::DisplayConnection display;
  std::vector<PictureBody> bodies;
  for (std::size_t f = 0; f + 1 < files.size(); ++f)
    bodies.push_back(fascia::io::read_picture_body(files[f], style.field));
  check_field(bodies, style.field);
  std::vector<PictureState> states = states_of(std::move(bodies), description, sheet);
  if (label) states.front().label = *label;
  fascia::io::render_picture(std::move(states), style, files.back());
  return 0;
}

}  // namespace

/// Exit status 0; 2 for wrong use or wrong content, 4 for files and displays, as the main program.
int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const InputError& e) {
    std::cerr << "fascia-picture: " << e.what() << "\n";
    return 2;
  } catch (const std::exception& e) {
    std::cerr << "fascia-picture: " << e.what() << "\n";
    return 4;
  }
}
