#include "io/picture/display.hpp"

#include "core/model/errors.hpp"

#include <X11/Xlib.h>

#include <cstdlib>
#include <string>

namespace fascia::io {

void check_display() {
  const char* name = std::getenv("DISPLAY");
  if (!name || *name == '\0')
    throw FileError("no display: DISPLAY is not set; run it on a desktop or under xvfb-run -a");
  Display* display = XOpenDisplay(nullptr);
  if (!display)
    throw FileError("no display: \"" + std::string(name) + "\" does not answer; run it on a desktop or under xvfb-run -a");
  XCloseDisplay(display);
}

}  // namespace fascia::io
