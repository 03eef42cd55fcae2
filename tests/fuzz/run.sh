#!/usr/bin/env bash
# Feeds every reader of files with damaged ones: tests/fuzz/run.sh [SECONDS [FORMAT...]], 30 seconds each. Needs Clang
# and is skipped without it. What crashes a reader is kept in build/fuzz/finds; exit 1 if anything does.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=${1:-30}
shift || true
command -v clang++ > /dev/null || { echo "fuzzing is skipped: it needs clang++"; exit 0; }
cmake --preset fuzz > /dev/null && cmake --build --preset fuzz --target fuzzers > build/fuzz/build.log 2>&1 \
    || { tail -20 build/fuzz/build.log; exit 1; }
if [[ $# -gt 0 ]]; then formats=("$@"); else mapfile -t formats < <(ls tests/fuzz/seeds); fi
mkdir -p build/fuzz/finds
found=0
for format in "${formats[@]}"; do
    corpus=build/fuzz/corpus/$format
    mkdir -p "$corpus"
    log=build/fuzz/$format.log
    # A reader may take a gigabyte of memory and 30 seconds for no file of 16 kB.
    if ASAN_OPTIONS=allocator_may_return_null=0 "build/fuzz/tests/fuzz/fuzz_$format" -max_total_time="$seconds" \
        -max_len=16384 -timeout=30 -rss_limit_mb=2048 -malloc_limit_mb=1024 -print_final_stats=1 \
        -artifact_prefix="build/fuzz/finds/$format-" "$corpus" "tests/fuzz/seeds/$format" > "$log" 2>&1; then
        runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
        covered=$(grep -oE 'cov: [0-9]+' "$log" | tail -1)
        echo "$format: $runs files, ${covered:-cov: ?} edges, nothing found"
    else
        found=1
        echo "$format: $(grep -m1 -E '^SUMMARY|ERROR' "$log" || tail -1 "$log"); see $log and build/fuzz/finds"
    fi
done
exit $found
