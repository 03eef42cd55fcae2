#!/usr/bin/env bash
# Sets up and runs every test. usage: tests/run.sh [PRESET] [ctest arguments]   (preset: dev)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-dev}
shift || true
bash third_party_notes/install_packages.sh build test
cmake --preset "$preset" -DNEARPOSE_TESTS=ON >/dev/null  # the demo turns them off
# Where the unit tests alone are asked for, the others are not built for nothing.
case "$*" in
    "-L unit") target=unit_tests ;;
    "-L library") target=library_tests ;;
    *) target=all ;;
esac
cmake --build --preset "$preset" --target "$target"
# Several tests run at once, each with threads of its own: a thread that waits must not keep a processor busy.
export OMP_WAIT_POLICY=passive
# Leaks of libraries below ours are left out without a word: tests count what a program says on its error stream.
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
ctest --test-dir "build/$preset" --output-on-failure --no-tests=error -j "$(nproc)" "$@"
