#pragma once

#include <memory>

namespace fascia::io {

/// An X display that can render, held open: where none answers, VTK itself would end the program, and a virtual display
/// that loses its last client starts anew and may refuse the next.
class DisplayConnection {
 public:
  /// @throws FileError  no display, or one without GLX
  DisplayConnection();

 private:
  std::shared_ptr<void> display_;
};

}  // namespace fascia::io
