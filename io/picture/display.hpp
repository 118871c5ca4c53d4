#pragma once

namespace fascia::io {

/// Fails where no X display answers: VTK itself would end the program.
/// @throws FileError
void check_display();

}  // namespace fascia::io
