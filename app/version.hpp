#pragma once

#include <string>

namespace fascia::app {

/// The program and its backends, for --version:
///
///     fascia 0.1.0
///     commit: 0123456789ab
///     backends: cpu, cuda (toolkit 13.0, for 90-real)
///     direct solver: supernodal Cholesky, ordered by METIS and AMD of SuiteSparse
///     processor: x86-64-v4
std::string version_text();

/// The processor that the library in use is compiled for: "x86-64", "x86-64-v3", "x86-64-v4", or, of a build for its
/// own machine, "native (znver3)". Of an installed library the loader picks the highest level that the processor has.
const char* tuning();

/// The commit that the program was built from, "-changed" where files differed from it; empty where there was no git.
const char* commit();

/// The backends that there are: "cpu, cuda (toolkit 13.0, for 90-real)".
std::string backend_list();

/// Names the backends without loading what computes on a GPU, which a run on the processor has no use for: "cpu, cuda"
/// where it has not been asked for.
std::string backends_so_far();

}  // namespace fascia::app
