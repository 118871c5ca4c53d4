#pragma once

namespace fascia::app {

/// Has the C library keep some MB that were freed, in place of giving them back to the system at once: a saved state
/// allocates and frees some hundred times, and each return and each first touch of a page costs a call of the kernel,
/// most of the time of small states. Frees a block of 4 MB, after which glibc takes blocks up to that size from its own
/// heap and gives that back where 8 MB lie free at its end, as it does by itself once a run has freed such a block.
void keep_freed_memory();

}  // namespace fascia::app
