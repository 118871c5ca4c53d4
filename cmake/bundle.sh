#!/usr/bin/env bash
# Makes a bundle that runs on another Linux machine of the same kind of processor, whatever is installed there.
set -euo pipefail
root=$(cd -P "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

usage() {
  cat <<'TEXT'
usage: cmake/bundle.sh [--build DIR] [--leave-out GLOB]... OUT [PROGRAM...]

  OUT              a folder that is made anew, with OUT.tar.gz beside it
  PROGRAM...       programs of the build; default: fascia
  --build DIR      default: build/release
  --leave-out GLOB a library that the other machine has, for example 'libvtk*'

The bundle holds the programs, stripped, every library that they load with the C library and its loader, the units
database and the scenes. Run OUT/bin/PROGRAM, from anywhere. GPU drivers are the other machine's own. A build tuned for
this processor (FASCIA_NATIVE=ON) needs one that knows the same instructions. Configure the build with the other machine's
FASCIA_CUDA_ARCHITECTURES, for example 90-real: otherwise its driver translates each kernel when it first runs.
TEXT
}

build=$root/build/release
left_out=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --build) build=$2; shift 2 ;;
    --leave-out) left_out+=("$2"); shift 2 ;;
    -*) usage >&2; exit 2 ;;
    *) break ;;
  esac
done
[ $# -ge 1 ] || { usage >&2; exit 2; }
out=$1
shift
programs=("$@")
[ $# -gt 0 ] || programs=(fascia)
for program in "${programs[@]}"; do
  [ -x "$build/$program" ] || { echo "bundle.sh: no program $build/$program; build it first" >&2; exit 2; }
done
if [ -e "$out" ] && [ ! -x "$out/bin/${programs[0]}" ]; then
  echo "bundle.sh: $out is there and is no bundle of ${programs[0]}; name another folder" >&2
  exit 2
fi

is_left_out() {
  local glob
  for glob in "${left_out[@]}"; do
    # shellcheck disable=SC2254 # a pattern
    case $1 in $glob) return 0 ;; esac
  done
  return 1
}

# Libraries of a program and theirs, as "NAME PATH", the loader among them.
libraries() {
  ldd "$1" | sed -nE 's|^\s*(\S+) => (/.*) \(0x.*|\1 \2|p; s|^\s*(/.*/)([^/ ]+) \(0x.*|\2 \1\2|p'
}

rm -rf "$out"
mkdir -p "$out/bin" "$out/lib" "$out/programs" "$out/share"
for program in "${programs[@]}"; do
  cp "$build/$program" "$out/programs/"
  libraries "$build/$program"
done | sort -u | while read -r name path; do
  is_left_out "$name" || cp -L "$path" "$out/lib/$name"
done

# The rest of the C library, of the version that a driver's library must find; and what TBB loads where it is there.
libc=$(libraries "$build/${programs[0]}" | sed -n 's/^libc.so.6 //p')
for name in libdl.so.2 libpthread.so.0 librt.so.1 libm.so.6 libutil.so.1 libresolv.so.2 libtbbmalloc.so.2 libiomp5.so; do
  [ ! -e "$(dirname "$libc")/$name" ] || cp -L "$(dirname "$libc")/$name" "$out/lib/"
done
# Modules, which the library loads from its own folder: the other commands, and the GPU part.
for module in fascia-tools fascia-cuda; do
  if [ -e "$out/lib/libfascia.so" ] && [ -e "$build/$module.so" ]; then cp "$build/$module.so" "$out/lib/"; fi
done
chmod u+w "$out"/lib/* "$out"/programs/*
strip --strip-unneeded "$out"/programs/* 2>/dev/null || true
find "$out/lib" -type f ! -name 'ld-linux*' -exec strip --strip-unneeded {} + 2>/dev/null || true
loader=$(cd "$out/lib" && echo ld-linux*)

for folder in /usr/share/xml/udunits /usr/local/share/udunits /usr/share/udunits; do
  if [ -f "$folder/udunits2.xml" ]; then cp -r "$folder" "$out/share/udunits"; break; fi
done
cp -r "$root/scenes" "$root/LICENSE" "$out/"

# Starts the program of its own name with the bundle's loader and libraries; LD_LIBRARY_PATH comes after them.
cat >"$out/bin/${programs[0]}" <<SH
#!/bin/sh
case \$0 in */*) here=\${0%/*} ;; *) here=. ;; esac
here=\$(cd "\$here/.." && pwd -P)
export UDUNITS2_XML_PATH="\$here/share/udunits/udunits2.xml" FASCIA_SOURCE_DIR="\${FASCIA_SOURCE_DIR:-\$here}"
exec "\$here/lib/$loader" --argv0 "\$0" --library-path "\$here/lib\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}" \\
  "\$here/programs/\${0##*/}" "\$@"
SH
chmod +x "$out/bin/${programs[0]}"
for program in "${programs[@]:1}"; do cp "$out/bin/${programs[0]}" "$out/bin/$program"; done

tar -C "$(dirname "$out")" -czf "$out.tar.gz" "$(basename "$out")"
if grep -qs '^FASCIA_NATIVE:BOOL=ON' "$build/CMakeCache.txt" && ! grep -qs '^FASCIA_LEVEL:STRING=.' "$build/CMakeCache.txt"; then
  echo "bundle.sh: tuned for this machine's processor; elsewhere, a build with" \
    "-DFASCIA_LEVEL=x86-64-v3 runs on most processors since 2015" >&2
fi
du -sh "$out" "$out.tar.gz" | awk '{ print $2 ": " $1 }'
