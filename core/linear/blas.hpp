#pragma once

namespace fascia {

/// Threads of the BLAS would share our cores and change results, those of CHOLMOD's own loops come whatever a scene
/// asks for: both keep to one.
void hold_blas_to_one_thread();

/// OpenBLAS takes a buffer at its first product, and tries for ever where the process may not have it: it takes it
/// here, once, where there is room.
/// @throws InputError  no room
void take_blas_buffer();

}  // namespace fascia
