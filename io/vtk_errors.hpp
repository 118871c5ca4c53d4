#pragma once

#include <vtkSmartPointer.h>

#include <string>

class vtkOutputWindow;

namespace fascia::io {

/// While it lives, VTK prints nothing: its first error or warning is kept instead. One at a time in a program.
class VtkErrors {
 public:
  VtkErrors();
  ~VtkErrors();
  VtkErrors(const VtkErrors&) = delete;
  VtkErrors& operator=(const VtkErrors&) = delete;

  /// The first of them in one line, without VTK's addresses and source places; empty where there was none.
  std::string first() const;

 private:
  vtkSmartPointer<vtkOutputWindow> former_, window_;
};

}  // namespace fascia::io
