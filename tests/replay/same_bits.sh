#!/usr/bin/env bash
# Do two builds of the program behave the same, to the bit? Runs both on the same inputs and compares the SHA-256 of all
# that they write, without what is measured time, the version and the paths of the outputs. A row a run; exit 1 where any
# differs.
# usage: tests/replay/same_bits.sh OLD [NEW] [--quick] [--keep DIR] [--data DIR] [--jobs N] [--only PATTERN]
#   OLD, NEW   programs (build/release/apps/nearpose); OLD alone records the simulated inputs
#   --quick    short recordings and tests/replay/odd.json alone; else also small.json, a seed of each row of accuracy.json
#              and the recorded sets
#   --keep     folder of the recordings and of OLD's outputs, which a later comparison with the same OLD takes over
#              [results/same_bits]
#   --data     folder of the recorded sets; left out where they are not there [../shared/data]
#   --jobs     runs side by side [as many as the machine has cores]
#   --only     runs whose name fits the pattern of the shell ('paper*')
# With OLD as NEW it shows that the program repeats itself; OLD alone only fills the folder for later comparisons.
set -euo pipefail
repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
fail() { echo "same_bits: $*" >&2; exit 2; }

programs=(); quick=no; keep=results/same_bits; data=$repository/../shared/data; jobs=$(nproc); only='*'
while [[ $# -gt 0 ]]; do
    case $1 in
        --quick) quick=yes ;;
        --keep | --data | --jobs | --only) [[ $# -gt 1 ]] || fail "$1 needs a value"; declare "${1#--}=$2"; shift ;;
        -*) fail "unknown option $1; see the head of this script" ;;
        *) programs+=("$1") ;;
    esac
    shift
done
[[ ${#programs[@]} -eq 1 || ${#programs[@]} -eq 2 ]] || fail "two programs are needed: OLD NEW"
for program in "${programs[@]}"; do [[ -x $program ]] || fail "$program is no program"; done
old=$(readlink -f "${programs[0]}"); new=$(readlink -f "${programs[1]:-$old}")
data=$(readlink -m "$data"); keep=$(readlink -m "$keep")
before=$keep/old-$(sha256sum "$old" | cut -c1-12); after=$keep/new-$(sha256sum "$new" | cut -c1-12)
mkdir -p "$before" "$after"

# The runs: a name each, and the program's arguments as one quoted line. @OUT stands for the folder of a run's outputs,
# @JOBS for the number of threads where results cannot depend on it.
names=(); declare -A command_of
add() { names+=("$1"); command_of[$1]=$(printf '%q ' "${@:2}"); }
recording() { add "simulate_$1" simulate --seed 1 --force --threads 1 --out @OUT "${@:2}"; }
recorded() { echo "$before/simulate_$1/out"; }  # OLD's run is what all others are given
estimate_in() { add "$1" estimate --scene "$2/test/000001" --models "$2/models" --run @OUT "${@:3}"; }
estimate() { estimate_in "$1" "$(recorded "$2")" "${@:3}"; }
experiment() { add "$1" experiment "$repository/$2" --out @OUT --threads @JOBS "${@:3}"; }

recording piston --scenario piston --frames 10
recording bracket --scenario sweep --frames 5 --part bracket
recording flange --scenario sweep --frames 6 --part flange
recording clutter --scenario clutter --frames 5
recording d435 --scenario handheld --frames 5 --sensor d435
recording dropped --scenario conveyor --frames 8 --drop-frames 0.3 --mask-bleed 4
piston=$(recorded piston)
estimate mask piston --threads 1
estimate mask_3_threads piston --threads 3
estimate no_mask piston --no-mask --threads 1 --last 4
estimate no_mask_3_threads piston --no-mask --threads 3 --last 4
estimate no_control piston --no-control --threads 1
estimate fixed_particles piston --particles 60 --seed 7 --threads 1 --last 4
estimate symmetries_none piston --symmetries none --tolerance-mm 0.5 --tolerance-deg 0.2 --threads 1 --last 4
for views in raycast raster sphere spheres; do
    estimate "paper_$views" piston --method paper --views $views --particles 60 --threads 1 --last 3
    [[ $views == raycast ]] || estimate "default_$views" piston --views $views --threads 1 --last 2
done
estimate paper_3_threads piston --method paper --particles 60 --threads 3 --last 3
estimate paper_no_mask piston --method paper --no-mask --no-control --threads 1 --last 1
estimate initial_pose piston --initial-pose "$before/start.json" --threads 1 --last 3
estimate bracket_no_mask bracket --object 3 --no-mask --threads 1
estimate flange flange --object 2 --last 4 --threads 1
estimate clutter_no_mask clutter --no-mask --threads 1
estimate d435 d435 --threads 1
estimate dropped dropped --threads 1
add evaluate evaluate --scene "$piston/test/000001" --models "$piston/models" --object 1 --results "$before/mask/out/poses.csv" \
    --log "$before/mask/out/log.jsonl" --out @OUT/errors.csv --json @OUT/errors.json --trajectory-out @OUT --plot @OUT/error.png
add render render --model "$piston/models/obj_000001.ply" --unit mm --camera "$piston/camera.json" --pose "$before/start.json" \
    --out @OUT/depth.png
experiment odd tests/replay/odd.json
if [[ $quick == no ]]; then
    experiment small apps/experiments/small.json
    experiment accuracy apps/experiments/accuracy.json --seeds 1
    for set in visp_castel visp_cube42 visp_rbt; do
        [[ -d $data/$set ]] || { echo "same_bits: $data/$set is not there: left out" >&2; continue; }
        for threads in 1 3; do
            estimate_in "${set}_$threads" "$data/$set" --threads $threads
            estimate_in "${set}_no_mask_$threads" "$data/$set" --no-mask --threads $threads
        done
    done
fi
# What counts of a file.
bits_of() {
    case $(basename "$1") in
        poses.csv) awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "time") out = i }
                            { for (i = 1; i <= NF; i++) if (i != out) printf "%s,", $i; print "" }' "$1" ;;
        log.jsonl) sed -E 's/"time_s":[^,}]*,?//; s/"seconds":\{[^}]*\},?//' "$1" ;;
        run.json) sed -E '/^  "program": \{/,/^  \}/d; /^    "(run|out|log|trajectory|pictures)":/d' "$1" ;;
        cell.json) sed -E '/^ "version":/d; /^ "time":/,$d' "$1" ;;
        results.json | results.csv | results.md) ;;  # made from the cells, with columns of time
        *) cat "$1" ;;
    esac
}
# perform PROGRAM FOLDER NAME: FOLDER/NAME/out as the program writes it, FOLDER/NAME/bits what is compared.
perform() {
    local program=$1 folder=$2/$3 command=${command_of[$3]//@JOBS/$jobs} status=0
    rm -rf "$folder"
    mkdir -p "$folder/bits"
    [[ $command == simulate* ]] || mkdir "$folder/out"
    local TIMEFORMAT='%U'
    { time eval "\"$program\" --quiet ${command//@OUT/$(printf %q "$folder/out")}" >"$folder/said" 2>&1 || status=$?
    } 2>"$folder/cpu_s"
    mkdir -p "$folder/out"
    (cd "$folder/out" && find . -type f) | while read -r file; do
        mkdir -p "$(dirname "$folder/bits/$file")"
        bits_of "$folder/out/$file" >"$folder/bits/$file"
    done
    echo "$status" >"$folder/bits/exit_code"
    (cd "$folder/bits" && find . -type f | sort | xargs -d '\n' sha256sum) >"$folder/sums"
    key_of "$3" >"$folder/key"  # last: what has none was cut short
}
# What a run depends on besides the program and the recordings, which are of OLD.
key_of() {
    echo "${command_of[$1]//"$repository"/}"
    local file=${command_of[$1]#experiment }
    [[ $file == "${command_of[$1]}" ]] || sha256sum <"${file%% *}"
}
is_kept() { [[ -f $before/$1/key && $(key_of "$1") == "$(cat "$before/$1/key")" ]]; }
# all PROGRAM FOLDER NAME...: as many side by side as there are jobs.
all() {
    local program=$1 folder=$2 name
    for name in "${@:3}"; do
        while [[ $(jobs -rp | wc -l) -ge $jobs ]]; do wait -n || true; done
        perform "$program" "$folder" "$name" &
    done
    wait
}
# What OLD has not yet done of these; it must end well, or it shows nothing.
all_of_old() {
    local missing=() name
    for name in "$@"; do is_kept "$name" || missing+=("$name"); done
    all "$old" "$before" "${missing[@]}"
    for name in "$@"; do
        [[ $(cat "$before/$name/bits/exit_code") == 0 ]] || fail "$name: OLD failed: $(tail -n 3 "$before/$name/said")"
    done
}

chosen=()
for name in "${names[@]}"; do
    # shellcheck disable=SC2053
    if [[ $name == $only ]]; then chosen+=("$name"); fi
done
[[ ${#chosen[@]} -gt 0 ]] || fail "no run's name fits $only"

mapfile -t first < <(printf '%s\n' "${names[@]}" | grep '^simulate_')
all_of_old "${first[@]}"
# The true pose of the first frame.
grep -oE '"cam_(R|t)_m2c": *\[[^]]*\]' "$piston/test/000001/scene_gt.json" | head -n 2 | paste -sd, | sed 's/.*/{&}/' >"$before/start.json"
all_of_old mask  # evaluated by both programs
all_of_old "${chosen[@]}"
if [[ ${#programs[@]} -eq 1 ]]; then echo "$before has the outputs of ${#chosen[@]} runs"; exit 0; fi
all "$new" "$after" "${chosen[@]}"

differing=0
for name in "${chosen[@]}"; do
    if cmp -s "$before/$name/sums" "$after/$name/sums"; then
        printf '%-24s same     %s  %8s s CPU\n' "$name" "$(sha256sum <"$after/$name/sums" | cut -c1-12)" \
            "$(cat "$after/$name/cpu_s")"
    else
        differing=$((differing + 1))
        printf '%-24s DIFFERS  diff -r %s %s\n' "$name" "$before/$name/bits" "$after/$name/bits"
    fi
done
echo "$differing of ${#chosen[@]} runs differ"
[[ $differing -eq 0 ]]
