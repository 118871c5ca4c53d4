#include "core/model/errors.hpp"
#include "io/picture/display.hpp"
#include "io/picture/picture.hpp"
#include "io/text_numbers.hpp"

#include <CLI/CLI.hpp>

#include <exception>
#include <iostream>

namespace {

using fascia::InputError;

/// Three numbers "x,y,z" that are not all zero.
std::array<double, 3> direction(const std::string& option, const std::string& text) {
  std::array<double, 3> result{};
  const InputError wrong(option + ": \"" + text + "\" must be three numbers x,y,z, not all zero");
  std::size_t begin = 0, count = 0;
  for (bool more = true; more; ++count) {
    const std::size_t comma = text.find(',', begin);
    more = comma != std::string::npos;
    const auto value = fascia::io::to_number(std::string_view(text).substr(begin, more ? comma - begin : comma));
    if (!value || count >= result.size()) throw wrong;
    result[count] = *value;
    begin = comma + 1;
  }
  if (count != result.size()) throw wrong;
  if (result == std::array<double, 3>{}) throw wrong;
  return result;
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

int run(int argc, char** argv) {
  std::vector<std::string> files;
  std::string view = "1,1,1", up, pixels = "1200x800";
  fascia::io::PictureStyle style;
  CLI::App app{"Renders results of fascia: fascia-picture RESULT.vtu... OUT.png"};
  app.add_option("files", files, "results (.vtu), then the picture (.png)")->required()->expected(2, 1 << 20);
  app.add_option("--view", view, "direction from the bodies to the eye, x,y,z")->capture_default_str();
  app.add_option("--up", up, "direction that points up in the picture, x,y,z (default: y)");
  app.add_option("--size", pixels, "width and height in pixels")->capture_default_str();
  app.add_option("--field", style.field, "point or cell field that colours the surface (magnitude of vectors)");
  app.add_option("--title", style.title, "text above the picture");
  app.add_flag("--frames", style.frames, "show the frames as balls in front of the surface");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  style.view = direction("--view", view);
  if (!up.empty()) style.up = direction("--up", up);
  style.size = size(pixels);

  const fascia::io::DisplayConnection display;
  std::vector<fascia::io::PictureBody> bodies;
  for (std::size_t f = 0; f + 1 < files.size(); ++f)
    bodies.push_back(fascia::io::read_picture_body(files[f], style.field));
  fascia::io::render_picture(bodies, style, files.back());
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
