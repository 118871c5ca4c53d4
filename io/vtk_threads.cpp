#include "io/vtk_threads.hpp"

#include <vtkSMPTools.h>

namespace fascia::io {

void without_vtk_threads(const std::function<void()>& work) {
  vtkSMPTools::Config config;
  config.Backend = "Sequential";
  vtkSMPTools::LocalScope(config, work);
}

}  // namespace fascia::io
