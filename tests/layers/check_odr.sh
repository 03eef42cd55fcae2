#!/usr/bin/env bash
# The one-definition rule: GCC compares the types and functions of all translation units of core, raycast, optim and apps
# with each other. A name that stands for two different things is an error; the linker would take one without a word.
# Exit 1 if any. usage: check_odr.sh [--self-test]   (the test of this script by itself alone; otherwise it comes first)
# Compiled without optimisation: with it GCC forgets types before they are compared (at -O1 three of the self-test's five).
# Merged by a partial link, which compares and makes no machine code.
set -euo pipefail
export LC_ALL=C
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
merge() {
    g++ -flto=2 -O0 -r -nostdlib -flinker-output=rel -Werror=odr -Werror=lto-type-mismatch -o "$work/merged.o" "$@"
}

# Types of two kinds, as value, member, its holder, element of a container and enumeration: each has to be found.
self_test() {
    local name found compile=(g++ -std=c++20 -O0 -w -flto -fno-fat-lto-objects -c "$work/types.cpp")
    cat >"$work/types.cpp" <<'END'
#include <vector>
enum class Kind { FIRST, SECOND };
struct Value { NUMBER x; };
struct Member { NUMBER x; };
struct Element { NUMBER x; };
class Holder { public: NUMBER get() const { return member_.x; } private: Member member_{3}; };
int USE(Kind kind) {
    Value value{2};
    Holder holder;
    std::vector<Element> elements{{1}};
    return static_cast<int>(value.x + holder.get() + elements[0].x) + static_cast<int>(kind);
}
END
    "${compile[@]}" -DUSE=one -DNUMBER=int -DFIRST=kA -DSECOND=kB -o "$work/one.o"
    "${compile[@]}" -DUSE=same -DNUMBER=int -DFIRST=kA -DSECOND=kB -o "$work/same.o"
    "${compile[@]}" -DUSE=other -DNUMBER=double -DFIRST=kB -DSECOND=kA -o "$work/other.o"
    merge "$work/one.o" "$work/same.o" || { echo "the check of the one-definition rule finds what is not there"; return 1; }
    found=$(merge "$work/one.o" "$work/other.o" 2>&1) && { echo "the check of the one-definition rule is no check"; return 1; }
    for name in Kind Value Member Element Holder; do
        grep -q "type .*$name. violates" <<<"$found" || { echo "the check of the one-definition rule overlooks $name"; return 1; }
    done
}

self_test
[[ ${1:-} == --self-test ]] && exit
cmake --preset odr >/dev/null
cmake --build --preset odr --target nearpose_core nearpose_raycast nearpose_optim nearpose_app_files nearpose_app_parts
merge -Wl,--whole-archive build/odr/{core,raycast,optim,apps}/*.a
