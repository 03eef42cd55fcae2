#!/usr/bin/env bash
# From a fresh machine to a picture of a tracked engine block: installs what is needed, builds, simulates an approach of a
# wrist camera to the built-in engine block, estimates its pose in every frame without any prior, shows the errors and
# writes a report to open in a browser.
# usage: apps/demo.sh [FOLDER]   (results; default results/demo)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=${1:-results/demo}
bash third_party_notes/install_packages.sh build
cmake --preset release -DNEARPOSE_TESTS=OFF >/dev/null
cmake --build --preset release --target nearpose
nearpose=build/release/apps/nearpose

mkdir -p "$out"
"$nearpose" simulate --scenario piston --seed 1 --out "$out/dataset" --force
"$nearpose" estimate --scene "$out/dataset/test/000001" --models "$out/dataset/models" --object 1 --run "$out" \
    --pictures "$out/pictures"
"$nearpose" evaluate --scene "$out/dataset/test/000001" --models "$out/dataset/models" --object 1 \
    --results "$out/poses.csv" --log "$out/log.jsonl" --out "$out/errors.csv" --plot "$out/error.png" \
    --curves "$out/error_over_distance.png"
folder=$(cd "$out" && pwd)
if "$nearpose" report "$out"; then echo "open $folder/report.html in a browser: the cloud, the particles and the block, frame by frame"; fi
echo "poses, log, table and pictures are in $folder"
