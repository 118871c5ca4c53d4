#pragma once

/// Marks a function that also compiles for the GPU.
#if defined(__CUDACC__)
#define FASCIA_HD __host__ __device__
#else
#define FASCIA_HD
#endif
