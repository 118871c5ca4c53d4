#!/usr/bin/env bash
# Makes the Debian packages fascia, libfascia-dev, fascia-picture and, where there is a CUDA toolkit, fascia-cuda.
set -euo pipefail
root=$(cd -P "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
. "$root/cmake/setup.sh"

if [ "${1:-}" = -h ] || [ "${1:-}" = --help ]; then
  cat <<'TEXT'
usage: cmake/package.sh [cmake arguments]

  Builds in build/package: the program for any amd64 processor, its library also for x86-64-v3 and x86-64-v4, of which the
  dynamic loader picks one. Writes build/package/*.deb. Further arguments go to cmake, for example -DFASCIA_CUDA=OFF.
  Equal sources give equal packages in any folder (CUDA's apart): dates are those of the last commit, or of
  SOURCE_DATE_EPOCH.
TEXT
  exit 0
fi
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct 2>/dev/null || echo 1767225600)}
export SOURCE_DATE_EPOCH
umask 022
configure package release -DFASCIA_NATIVE=OFF -DFASCIA_TESTS=OFF -DFASCIA_PRECOMPILE=OFF -DFASCIA_CUDA_ARCHITECTURES=80-virtual \
  "-DFASCIA_LEVELS=x86-64-v3;x86-64-v4" -DCMAKE_INSTALL_PREFIX=/usr "$@"
cmake --build "$root/build/package"
rm -f "$root"/build/package/*.deb
(cd "$root/build/package" && cpack -G DEB)
