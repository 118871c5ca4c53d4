#pragma once

namespace fascia::app {

/// Has the C library keep up to 64 MB that were freed, in place of giving them back to the system at once: a saved
/// state allocates and frees some hundred times, and each return and each first touch of a page costs a call of the
/// kernel, most of the time of small states. Blocks above 32 MB go back as before.
void keep_freed_memory();

}  // namespace fascia::app
