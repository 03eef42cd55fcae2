#!/usr/bin/env bash
# Installs a build, moves the prefix (an installed package must not know where it was built), then configures, builds and
# runs the project beside this file against it, with the example of README.md. usage: run.sh BUILD_FOLDER
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$(cd "$1" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/first" >/dev/null
mv "$work/first" "$work/prefix"
mkdir "$work/build"
awk '/^```cpp$/ { copying = 1; next } /^```$/ { copying = 0 } copying' "$root/README.md" >"$work/build/readme_example.inc"
grep -q nearpose "$work/build/readme_example.inc" || { echo "README.md has no C++ example" >&2; exit 1; }
cmake -G Ninja -S "$root/tests/consumer/project" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$work/build"
"$work/build/consumer" "$root/apps/models/engine_block.ply"
"$work/prefix/bin/nearpose" --version
