#!/usr/bin/env bash
# Installs the library of a build into a folder, builds examples/embed from it as a program of somebody else, with other
# flags than the library's, and runs it: embed.sh BUILD
set -euo pipefail
build=$(cd "$1" && pwd -P)
source=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$build/CMakeCache.txt")
work=$(mktemp -d "${TMPDIR:-/tmp}/fascia embed XXXXXX")
trap 'rm -rf "$work"' EXIT
fail() { echo "embed: $*" >&2; exit 1; }

for component in fascia dev; do cmake --install "$build" --component "$component" --prefix "$work/prefix" >"$work/install.log"; done
cp -r "$source/examples/embed" "$work/embed"
[ "$(grep -c . "$work/embed/embed.cpp")" -le 40 ] || fail "the example has more than forty lines"
cat >"$work/embed/scene.cpp" <<'CPP'
#include <fascia/scene_file.hpp>
#include <fascia/stepper.hpp>
int main(int, char** arguments) { return fascia::Stepper(fascia::read_scene_file(arguments[1])).step(0.01).converged ? 0 : 1; }
CPP
cat >>"$work/embed/CMakeLists.txt" <<'CMAKE'
add_executable(scene scene.cpp)
target_link_libraries(scene PRIVATE fascia::scene_files)
install(TARGETS embed)
CMAKE
export CXXFLAGS="-O1 -march=x86-64 -Wall -Wextra -Wconversion -Wshadow -Werror"
cmake -S "$work/embed" -B "$work/build" "-DCMAKE_PREFIX_PATH=$work/prefix" >"$work/configure.log" || { cat "$work/configure.log"; exit 1; }
cmake --build "$work/build" >"$work/build.log" || { cat "$work/build.log"; exit 1; }
if ldd "$work/build/embed" | grep -iE 'vtk|toml|udunits|not found'; then fail "links what it must not"; fi
ldd "$work/build/embed" | grep -F "$work/prefix" | grep -q libfascia.so || fail "runs another library than the installed one"

"$work/build/embed" | tee "$work/output"
"$work/build/scene" "$work/prefix/share/fascia/scenes/struck_beam.toml" || fail "a scene file is not stepped"
cmake --install "$work/build" --prefix "$work/elsewhere" >>"$work/install.log"
"$work/elsewhere/bin/embed" | cmp - "$work/output" || fail "an installed program does not find the library"
# On the GPU, or in the space of the host that stands for one; where there is neither, a sentence says so.
if [ -n "${FASCIA_DEVICE_MODULE:-}" ]; then
  "$work/build/embed" cuda | tee "$work/device"
  cmp "$work/output" "$work/device" || fail "the steps of the GPU end elsewhere"
fi
if FASCIA_DEVICE_MODULE=none "$work/build/embed" cuda 2>"$work/refusal"; then fail "took a GPU that is not there"; fi
grep -q "no CUDA backend" "$work/refusal" || fail "$(cat "$work/refusal")"
