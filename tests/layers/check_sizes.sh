#!/usr/bin/env bash
# The sizes: no function of C++ or Python over 50 lines, no source file over 300 lines, no class with more than eight data
# members that can change. Prints every breach as "file:line: name, size (limit)"; exit 1 if any.
# usage: check_sizes.sh [FILE...]   (default: the files under version control, after a test of this script by itself)
# Universal Ctags reads the C++. A class is a `class`, a struct with private data, or a struct Impl behind a pointer; plain
# structs (options, results) may be as wide as what they describe. Const and static members and references do not count.
set -euo pipefail
max_function_lines=50 max_file_lines=300 max_members=8
here=$(realpath "${BASH_SOURCE[0]}")

large_files() {
    awk -v limit=$max_file_lines '
        FNR == 1 { report() }
        { name = FILENAME; lines = FNR }
        function report() { if (lines > limit) printf "%s:1: file, %d lines (%d)\n", name, lines, limit }
        END { report() }' "$@"
}

# One line a function and a data member: kind, file, line, end, name, scope, access, properties, type (tab between).
tags_of() {
    ctags --langmap=C++:.cpp.hpp --languages=C++,Python --kinds-C++=fm --kinds-Python=fm --fields=nKeasSt \
        --fields-C++=+'{properties}' --excmd=number --sort=no -o - "$@" |
        awk -F'\t' -v OFS='\t' '!/^!_TAG_/ {
            split("", value)
            for (i = 5; i <= NF; i++) { at = index($i, ":"); value[substr($i, 1, at - 1)] = substr($i, at + 1) }
            scope = "class" in value ? "class:" value["class"] : "struct" in value ? "struct:" value["struct"] : "-"
            type = value["typeref"]
            sub(/^typename:/, "", type)
            print $4, $2, value["line"], value["end"], $1, scope, value["access"], value["properties"] "-", type
        }'
}

large_functions() {
    awk -F'\t' -v limit=$max_function_lines '
        $1 != "member" || $2 ~ /\.py$/ {
            lines = $4 - $3 + 1
            if (lines > limit) printf "%s:%d: function %s, %d lines (%d)\n", $2, $3, $5, lines, limit
        }'
}

wide_classes() {
    awk -F'\t' -v limit=$max_members '
        $1 != "member" || $2 ~ /\.py$/ || $8 ~ /static/ { next }
        { class = $2 "\t" $6 }
        $6 ~ /^class:/ || $6 ~ /::Impl$/ || $7 == "private" { counts[class] = 1 }
        !(class in line) { line[class] = $3 }
        $9 ~ /&$/ || $9 ~ /\* *const$/ || ($9 ~ /^const / && $9 !~ /\*$/) { next }
        { members[class]++ }
        END {
            for (class in counts) if (members[class] > limit) {
                split(class, part, "\t")
                sub(/^[a-z]*:/, "", part[2])
                gsub(/__anon[0-9a-f]+/, "(unnamed)", part[2])
                printf "%s:%d: class %s, %d data members that can change (%d)\n", part[1], line[class], part[2],
                       members[class], limit
            }
        }' | sort
}

check() {
    local tags breaches
    tags=$(tags_of "$@")
    grep -q '^function' <<<"$tags" || { echo "no functions found: is ctags at work?"; return 1; }
    breaches=$(large_files "$@"; large_functions <<<"$tags"; wide_classes <<<"$tags")
    [[ -z $breaches ]] && return
    echo "$breaches"
    return 1
}

repeat() { for ((i = 1; i <= $1; i++)); do printf "$2\n" "$i"; done; }

# One offender of each kind, and beside each what is just within the limit: the script has to tell them apart.
self_test() {
    local folder expected found
    folder=$(mktemp -d)
    trap 'rm -rf "$folder"' RETURN
    { echo "int fits() {"; repeat 48 "    // %d"; echo "}"
      echo "template <typename T>"; echo "T Part<T>::too_long(const T& t) const {"; repeat 49 "    // %d"; echo "}"; } >"$folder/functions.cpp"
    { echo "def fits():"; repeat 49 "    x = %d"; echo "def too_long():"; repeat 50 "    x = %d"; } >"$folder/functions.py"
    { echo "namespace part {"; echo "class TooWide {"; echo "  public:"; echo "    int get() const { return value_1_; }"
      echo "  private:"; repeat 7 "    int value_%d_ = 0;"
      echo "    const std::vector<int>* pointer_ = nullptr;"; echo "    mutable std::shared_ptr<const int> shared_;"; echo "};"
      echo "class Fits {"; echo "    struct Inner {"; repeat 9 "        int inner_%d;"; echo "    };"; repeat 8 "    int value_%d_ = 0;"
      echo "    const double constant_ = 1.0;"; echo "    int& reference_;"; echo "    static int shared_;"
      echo "    static constexpr double kLimit = 1.0;"; echo "    int* const fixed_;"; echo "};"
      echo "struct Options {"; repeat 9 "    double value_%d = 0.0;"; echo "};"
      echo "struct Hidden {"; echo "  private:"; repeat 9 "    double value_%d = 0.0;"; echo "};"
      echo "struct Recording::Impl {"; repeat 9 "    double value_%d = 0.0;"; echo "};"; echo "}  // namespace part"; } >"$folder/classes.hpp"
    repeat 300 "// %d" >"$folder/fits.js"
    repeat 301 "# %d" >"$folder/too_long.sh"
    expected=$(cat <<END
too_long.sh:1: file, 301 lines (300)
functions.cpp:52: function too_long, 51 lines (50)
functions.py:51: function too_long, 51 lines (50)
classes.hpp:6: class part::TooWide, 9 data members that can change (8)
classes.hpp:$(grep -n 'struct Hidden' "$folder/classes.hpp" | awk -F: '{ print $1 + 2 }'): class part::Hidden, 9 data members that can change (8)
classes.hpp:$(grep -n '::Impl' "$folder/classes.hpp" | awk -F: '{ print $1 + 1 }'): class part::Recording::Impl, 9 data members that can change (8)
END
)
    found=$(cd "$folder" && bash "$here" classes.hpp fits.js functions.cpp functions.py too_long.sh) &&
        { echo "the check of sizes passes files that are too large"; return 1; }
    diff <(sort <<<"$expected") <(sort <<<"$found") || { echo "the check of sizes does not find what it should"; return 1; }
}

ctags --version 2>/dev/null | grep -q Universal || { echo "Universal Ctags is missing"; exit 1; }
if [[ $# -gt 0 ]]; then check "$@"; exit; fi
self_test
cd "$(dirname "$here")/../.."
mapfile -t files < <(git ls-files '*.cpp' '*.hpp' '*.js' '*.mjs' '*.py' '*.sh' .ci/run)
[[ ${#files[@]} -gt 100 ]] || { echo "no sources found"; exit 1; }
check "${files[@]}"
