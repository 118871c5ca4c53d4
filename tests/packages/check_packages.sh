#!/usr/bin/env bash
# Makes the packages in two folders and compares them, installs them into an empty folder, and runs the program there.
# Without CUDA, whose compiler is not reproducible. Part of ./check --all.
set -euo pipefail
root=$(cd -P "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() { echo "packages: $*" >&2; exit 1; }

echo "== two folders, equal packages"
mkdir "$work/first" "$work/a folder with spaces"
for folder in "$work/first" "$work/a folder with spaces"; do
  (cd "$root" && { git ls-files -z --cached --others --exclude-standard 2>/dev/null || find . -path ./build -prune -o -type f -print0; } |
    while IFS= read -r -d '' file; do [ ! -e "$file" ] || printf '%s\0' "$file"; done | xargs -0 cp --parents -t "$folder")
  SOURCE_DATE_EPOCH=1767225600 bash "$folder/cmake/package.sh" -DFASCIA_CUDA=OFF
done
(cd "$work/first/build/package" && sha256sum -- *.deb) | (cd "$work/a folder with spaces/build/package" && sha256sum --check) ||
  fail "the packages differ"
build=$work/first/build/package

echo "== lintian"
if command -v lintian >/dev/null; then
  lintian --fail-on error --suppress-tags bogus-mail-host,initial-upload-closes-no-bugs "$build"/*.deb || fail "lintian found errors"
fi

echo "== unpacked, as installed"
for package in "$build"/fascia_*.deb; do dpkg-deb -x "$package" "$work/system"; done
program=$work/system/usr/bin/fascia
size=$(du -sk "$work/system" | cut -f 1)
echo "installed: $size KiB"
[ "$size" -le 40960 ] || fail "larger than 40 MiB"
"$program" --version
"$program" run "$work/system/usr/share/fascia/scenes/soft_cantilever.toml" --quiet --output "$work/result"
level=$(sed -n 's/.*"library": "\(.*\)".*/\1/p' "$work/result/summary.json")
best=$(/lib64/ld-linux-x86-64.so.2 --help | sed -n 's/ *\(x86-64-v[34]\) (supported, searched)/\1/p' | sort | tail -n 1)
[ "$level" = "${best:-x86-64}" ] || fail "the loader picked $level, not ${best:-x86-64}"
if LC_ALL=C ldd "$program" | grep -i 'vtkRendering\|not found'; then fail "needs what it must not"; fi
if grep -rqF "$work" "$work/system/usr"; then fail "a path of the build stands in what is installed"; fi

echo "== each level alone gives the same result"
libraries=$(dirname "$(find "$work/system" -name libfascia.so -not -path '*hwcaps*')")
mv "$libraries/glibc-hwcaps" "$work/hwcaps"
for level in x86-64 x86-64-v3 x86-64-v4; do
  if [ "$level" != x86-64 ] && [[ "$level" > "${best:-x86-64}" ]]; then continue; fi
  rm -rf "$libraries/glibc-hwcaps"
  if [ "$level" != x86-64 ]; then mkdir "$libraries/glibc-hwcaps" && cp -r "$work/hwcaps/$level" "$libraries/glibc-hwcaps/"; fi
  "$program" --version | grep -qx "processor: $level" || fail "$level is not what runs"
  "$program" run "$work/system/usr/share/fascia/scenes/soft_cantilever.toml" --quiet --output "$work/$level"
  awk -F, -v level="$level" 'END { printf "%-10s tip %s %s\n", level, $2, $3; if ($2 + 1.55 > 0.1 || $2 + 1.55 < -0.1) exit 1 }' \
    "$work/$level/probes.csv" || fail "$level gives another result"
  for threads in 1 2; do
    "$program" run "$work/system/usr/share/fascia/scenes/three_beams.toml" --quiet --threads $threads --output "$work/$level-$threads"
  done
  cmp "$work/$level-1/probes.csv" "$work/$level-2/probes.csv" || fail "$level rounds otherwise on two threads"
done

echo "== installed without packages, into a folder with spaces"
cmake --install "$build" --prefix "$work/of my own" >/dev/null
"$work/of my own/bin/fascia" run "$work/of my own/share/fascia/scenes/soft_cantilever.toml" --quiet --output "$work/own"
"$work/of my own/bin/fascia" list scenes | grep "^  soft_cantilever.toml  *Soft cantilever" >/dev/null || fail "no scenes listed"
bash -n "$work/of my own/share/bash-completion/completions/fascia"
echo "packages: passed"
