#!/usr/bin/env bash
# Builds and runs the benchmarks, writes their results as JSON and prints a table of medians and ratios.
# usage: tests/bench/run.sh [--check] [--quick] [BUILD_FOLDER]
#   --check       exit 1 where a goal is missed; goals are of CPU time's ratios and of memory, never of elapsed time
#   --quick       stages only: neither whole frames nor sizes
#   BUILD_FOLDER  one that is built already with NEARPOSE_BENCH=ON; else the preset `bench` is built
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
check=() quick=0 build=
for argument in "$@"; do
    case $argument in
        --check) check=(--check) ;;
        --quick) quick=1 ;;
        -*) sed -n '3,6s/^# //p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
        *) build=$argument ;;
    esac
done
if [[ -z $build ]]; then
    build=build/bench
    bash third_party_notes/install_packages.sh build bench
    cmake --preset bench -DNEARPOSE_TESTS=OFF >/dev/null
    cmake --build --preset bench --target nearpose_bench nearpose_bench_table
fi
out=$build/bench-results
rm -rf "$out"
mkdir -p "$out"

# run NAME REPETITIONS FILTER: one process, since the largest memory is that of a process
run() {
    "$build/tests/bench/nearpose_bench" --benchmark_filter="$3" --benchmark_repetitions="$2" \
        --benchmark_min_time=0.05 --benchmark_enable_random_interleaving=true --benchmark_out="$out/$1.json" --benchmark_out_format=json >/dev/null 2>"$out/$1.log" ||
        { cat "$out/$1.log" >&2; exit 1; }
}
run stages 5 '^(decoding|views|neighbours|consensus|least_squares|likelihood|observation|fine_fit|refinement|start)/'
if [[ $quick -eq 0 ]]; then
    run frame 3 '^frame/'
    run latency 3 '^(first|held|budget)/'
    for scale in particles image_width; do run "$scale" 1 "^scale/$scale/"; done
    for thousands in 2 12 106 957; do run "triangles-$thousands" 1 "^scale/thousand_triangles/$thousands/"; done
fi
echo "results: $out" >&2
"$build/tests/bench/nearpose_bench_table" "${check[@]}" "$out"/*.json
