#!/usr/bin/env bash
# The layers: includes go apps -> {raycast, optim} -> core, never back, never raycast <-> optim; each heavy library enters
# one folder and only its .cpp files, so that no installed header includes it. Inside a folder they go from a room to the
# rooms below it. Prints every breach; exit 1 if any.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
breaches=0
# forbid WHAT WHY FILES...: no #include of a name that matches WHAT in FILES
forbid() {
    local what=$1 why=$2
    shift 2
    local found
    found=$(grep -nE "^[[:space:]]*#[[:space:]]*include[[:space:]]*[<\"]($what)" "$@" /dev/null)
    [[ -z $found ]] && return
    echo "$why:"
    echo "$found"
    breaches=1
}
# check_room_order FOLDER ROOM...: the rooms of FOLDER from the bottom to the top; a file includes only its own room and
# those before it. A room is a folder, or the name without its ending of files that lie in FOLDER itself. Rooms in one
# word, as in 'a b', stand side by side and do not include each other. A source file in no room of the list is a breach.
check_room_order() {
    local folder=$1
    shift
    local found
    found=$({
        printf 'room %s\n' "$@"
        files "$folder" | sed 's/^/file /'
        files "$folder" | xargs grep -nE "^[[:space:]]*#[[:space:]]*include[[:space:]]*[<\"]$folder/" /dev/null
    } | awk -v folder="$folder/" '
        function room(path) {
            path = substr(path, length(folder) + 1)
            sub(path ~ "/" ? "/.*" : "[.][a-z]+$", "", path)
            return path
        }
        $1 == "room" { ++height; for (i = 2; i <= NF; ++i) height_of[$i] = height; next }
        $1 == "file" { if (!(room($2) in height_of)) print $2 ": is in no room of the list"; next }
        {
            own = room(substr($0, 1, index($0, ":") - 1))
            split($0, parts, /[<"]/)
            other = room(parts[2])
            if (height_of[other] > height_of[own] || (other != own && height_of[other] == height_of[own])) print
        }')
    [[ -z $found ]] && return
    echo "a room of $folder includes what is not below it:"
    echo "$found"
    breaches=1
}
files() { find "$@" -name '*.hpp' -o -name '*.cpp' | sort; }
mapfile -t core < <(files core)
mapfile -t raycast < <(files raycast)
mapfile -t optim < <(files optim)
mapfile -t apps < <(files apps)
mapfile -t headers < <(find core raycast optim -name '*.hpp' -not -path '*/internal/*')  # those that are installed
[[ ${#core[@]} -gt 10 && ${#headers[@]} -gt 10 ]] || { echo "no sources found"; exit 1; }

forbid 'raycast/|optim/|apps/' 'core looks outside' "${core[@]}"
forbid 'optim/|apps/' 'raycast looks at optim or apps' "${raycast[@]}"
forbid 'raycast/(embree|raster|sphere|nested|depth_renderer|surface|symmetry)' \
    'mesh files look at what casts rays' $(files raycast/mesh_files)
forbid 'raycast/(mesh|embree|raster|sphere|nested|depth_renderer|surface)' \
    'the search for symmetries sees the part through the port of views alone' $(files raycast/symmetry)
forbid 'assimp/' 'assimp outside assimp_reader.cpp' $(printf '%s\n' "${raycast[@]}" | grep -vx raycast/mesh_files/assimp_reader.cpp)
forbid 'embree[34]/' 'Embree outside embree_scene.cpp' $(printf '%s\n' "${raycast[@]}" | grep -vx raycast/embree_scene.cpp)
forbid 'raycast/|apps/' 'optim looks at raycast or apps' "${optim[@]}"
forbid 'tests/' 'the product looks at its tests' "${core[@]}" "${raycast[@]}" "${optim[@]}" "${apps[@]}"
forbid 'embree|assimp|flann|ceres/|omp\.h' 'a header that is installed includes a heavy library' "${headers[@]}"
forbid 'embree|assimp|ceres/' 'a heavy library outside its folder' "${core[@]}" "${apps[@]}"
forbid 'optim/|raycast/embree|core/(estimator|update|fit|evidence|observation|filter/(association|gradient_step)|base/point_index)' \
    'a naive baseline uses what is compared with it' $(files tests/bench/naive)
forbid 'ceres/|flann|omp\.h' 'a heavy library outside its folder' "${raycast[@]}"
forbid 'embree|assimp|flann|omp\.h' 'a heavy library outside its folder' "${optim[@]}"
forbid 'flann|omp\.h' 'a heavy library outside its folder' "${apps[@]}"
forbid 'opencv' 'OpenCV outside stereo_matcher.cpp' "${core[@]}" "${raycast[@]}" "${optim[@]}" \
    $(printf '%s\n' "${apps[@]}" | grep -vx apps/depth_sensor/stereo_matcher.cpp)
forbid 'tiff' 'libtiff outside tiff_file.cpp' $(printf '%s\n' "${apps[@]}" | grep -vx apps/data_set/tiff_file.cpp)
forbid 'Imf|OpenEXR' 'OpenEXR outside exr_file.cpp' $(printf '%s\n' "${apps[@]}" | grep -vx apps/data_set/exr_file.cpp)

# Values; the ports; what is measured; shapes, evidence, filter, search and fit, each on those before it; the method and
# its options; the stages of an update; the estimator.
check_room_order core base 'view_generator correspondences' pose_solver observation shape evidence filter search fit world \
    method options result update estimator

# Rooms that several commands share, then one room a command, then the list of the commands.
check_room_order apps base data_set part_model depth_sensor scenes error_measures tables pictures runs set_up view_quality \
    'calibrate compare estimate evaluate experiment fit_sensor import render report simulate' program main

for library in embree assimp flann omp; do
    count=$(grep -lE "^#[[:space:]]*include[[:space:]]*<$library" "${core[@]}" "${raycast[@]}" | wc -l)
    [[ $count -le 2 ]] || { echo "$library is included by $count files"; breaches=1; }
done
pragmas=$(grep -lE '^[[:space:]]*#pragma omp' "${core[@]}" "${raycast[@]}" "${optim[@]}" "${apps[@]}")
[[ $pragmas == core/base/parallel.cpp ]] || { echo "OpenMP outside core/base/parallel.cpp: $pragmas"; breaches=1; }
exit $breaches
