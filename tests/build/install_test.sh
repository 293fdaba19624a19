#!/usr/bin/env bash
# Usage: install_test.sh CMAKE SOURCE_DIR BUILD_DIR: installs the built tree into a temporary folder, builds
# examples/embed there with find_package(hemiray), runs it, and runs the installed program on an installed scene.
set -euo pipefail
cmake=$1 source=$2 build=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$cmake" --install "$build" --prefix "$work/installed" >"$work/install.log" || { cat "$work/install.log"; exit 1; }
cp -r "$source/examples/embed" "$work/embed"  # away from the sources, so that only the installed header is seen
"$cmake" -S "$work/embed" -B "$work/embed/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/installed" \
  -DCMAKE_BUILD_TYPE=Release >"$work/configure.log" 2>&1 || { cat "$work/configure.log"; exit 1; }
"$cmake" --build "$work/embed/build"

cd "$work"
scene=$work/installed/share/hemiray/scenes/cornell_box.json
"$work/embed/build/embed" "$scene" embed.png
test -s embed.png
"$work/installed/bin/hemiray" check "$scene"

# Only the public namespace is exported: a neighbour's copy of a dependency must not meet ours.
library=$(find "$work/installed" -name 'libhemiray.so')
foreign=$(nm -DC --defined-only "$library" | grep -vE '( |for )hemiray::api::' || true)
if [[ -n $foreign ]]; then
  printf 'exported by libhemiray.so but not public:\n%s\n' "$foreign"
  exit 1
fi
