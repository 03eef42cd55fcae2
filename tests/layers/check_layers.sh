#!/usr/bin/env bash
# The layers: includes go apps -> {raycast, optim} -> core, never back, never raycast <-> optim; each heavy library enters
# one folder and only its .cpp files, so that no installed header includes it. Prints every breach; exit 1 if any.
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
forbid 'optim/|raycast/embree|core/(correspondence|estimator|fine_fit|gradient_step|likelihood|observation|point_index)' \
    'a naive baseline uses what is compared with it' $(files tests/bench/naive)
forbid 'ceres/|flann|omp\.h' 'a heavy library outside its folder' "${raycast[@]}"
forbid 'embree|assimp|flann|omp\.h' 'a heavy library outside its folder' "${optim[@]}"
forbid 'flann|omp\.h' 'a heavy library outside its folder' "${apps[@]}"
for library in embree assimp flann omp; do
    count=$(grep -lE "^#[[:space:]]*include[[:space:]]*<$library" "${core[@]}" "${raycast[@]}" | wc -l)
    [[ $count -le 2 ]] || { echo "$library is included by $count files"; breaches=1; }
done
pragmas=$(grep -lE '^[[:space:]]*#pragma omp' "${core[@]}" "${raycast[@]}" "${optim[@]}" "${apps[@]}")
[[ $pragmas == core/parallel.cpp ]] || { echo "OpenMP outside core/parallel.cpp: $pragmas"; breaches=1; }
exit $breaches
