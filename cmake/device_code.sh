#!/usr/bin/env bash
# Compiles a CUDA source to the device's intermediate code, for its errors alone: device_code.sh SOURCE STAMP nvcc
# ARGUMENTS... Touches STAMP. What compiled is remembered in the user's cache by its preprocessed text; any clone profits.
set -euo pipefail
source=$1 stamp=$2
shift 2
known=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/fascia/device
key=$({ echo "${@:2}"; "$1" --version; "$@" -E "$source" | grep -v '^#'; } | sha256sum | cut -d' ' -f1)
if [ ! -e "$known/$key" ]; then
  "$@" -ptx "$source" -o "$stamp"
  { mkdir -p "$known" && : >"$known/$key"; } 2>/dev/null || true
fi
: >"$stamp"
