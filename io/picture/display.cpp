#include "io/picture/display.hpp"

#include "core/base/errors.hpp"

#include <X11/Xlib.h>

#include <cstdlib>
#include <string>

namespace fascia::io {

DisplayConnection::DisplayConnection() {
  const std::string remedy = "; run it on a desktop or under xvfb-run -a";
  const char* name = std::getenv("DISPLAY");
  if (!name || *name == '\0') throw FileError("no display: DISPLAY is not set" + remedy);
  Display* display = XOpenDisplay(nullptr);
  if (!display) throw FileError("no display: \"" + std::string(name) + "\" does not answer" + remedy);
  display_ = std::shared_ptr<void>(display, [](void* d) { XCloseDisplay(static_cast<Display*>(d)); });
  int opcode = 0, event = 0, error = 0;
  if (!XQueryExtension(display, "GLX", &opcode, &event, &error))
    throw FileError("no display: \"" + std::string(name) + "\" cannot render (it has no GLX)" + remedy);
}

}  // namespace fascia::io
