#!/usr/bin/env bash
# Makes the tables and pictures of apps/EVALUATION.md from nothing: installs what is needed, builds, runs the grid of
# apps/experiments/evaluation.json and accuracy.json (hours; the same command goes on where it was stopped) and puts what came
# out below the document's mark. What is written above the mark stays.
# usage: apps/evaluation.sh [FOLDER]   (results; default results/evaluation)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=${1:-results/evaluation}
document=apps/EVALUATION.md
mark='<!-- Made by apps/evaluation.sh from here on. -->'
bash third_party_notes/install_packages.sh build
cmake --preset release -DNEARPOSE_TESTS=OFF >/dev/null
cmake --build --preset release --target nearpose
nearpose=build/release/apps/nearpose
"$nearpose" experiment apps/experiments/evaluation.json --out "$out"
"$nearpose" experiment apps/experiments/accuracy.json --out "$out/accuracy"

# What a run looks like: the first, a middle and the last frame of an approach, with the outline of the estimate.
"$nearpose" simulate --scenario piston --seed 1 --out "$out/piston/dataset" --force
"$nearpose" estimate --scene "$out/piston/dataset/test/000001" --models "$out/piston/dataset/models" --object 1 --run "$out/piston/run" \
    --pictures "$out/piston/pictures"

line=$(grep -nxF -- "$mark" "$document" | cut -d: -f1) || { echo "nearpose: $document has no line  $mark" >&2; exit 1; }
mkdir -p apps/experiments/pictures
rm -f apps/experiments/pictures/*.png  # the README's animation stays
cp "$out"/*.png "$out"/accuracy/*.png apps/experiments/pictures/
for frame in 000000 000030 000059; do cp "$out/piston/pictures/$frame.png" "apps/experiments/pictures/piston-$frame.png"; done
{
    head -n "$line" "$document"
    echo
    # Lines of at most 100 characters, but for tables.
    cat <(tail -n +3 "$out/accuracy/results.md") <(tail -n +3 "$out/results.md") |
        sed 's|](\([a-z0-9-]*\.png\))|](experiments/pictures/\1)|' |
        while IFS= read -r text; do
            if [[ $text == \|* ]]; then printf '%s\n' "$text"; else fold -s -w 100 <<<"$text" | sed 's/ *$//'; fi
        done
} >"$document.new"
mv "$document.new" "$document"
echo "the tables and pictures in $document are those of $out"
