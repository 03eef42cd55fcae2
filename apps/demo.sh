#!/usr/bin/env bash
# From a fresh machine to a picture of a tracked engine block: installs what is needed, builds, simulates an approach of a
# wrist camera to the built-in engine block, estimates its pose in every frame without any prior, and shows the errors.
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
"$nearpose" estimate --scene "$out/dataset/test/000001" --models "$out/dataset/models" --object 1 --out "$out/poses.csv" \
    --log "$out/log.jsonl" --trajectory "$out/poses.tum" --pictures "$out/pictures"
"$nearpose" evaluate --scene "$out/dataset/test/000001" --models "$out/dataset/models" --object 1 \
    --results "$out/poses.csv" --out "$out/errors.csv" --plot "$out/error.png"
echo "poses, log, table and pictures are in $(cd "$out" && pwd)"
