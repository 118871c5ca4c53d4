#pragma once

#include <functional>

namespace fascia::io {

/// Does work with VTK in this thread alone. VTK's own threads look for ranges of values even in a handful of them, and
/// wait for more work for longer than that takes. For one thread at a time: what VTK does elsewhere in the process
/// meanwhile is done so too.
void without_vtk_threads(const std::function<void()>& work);

}  // namespace fascia::io
