#!/usr/bin/env bash
# Installs the packages of packages.txt that are missing. usage: install_packages.sh KIND... (build, stereo, images, test, bench, check, nightly)
# Does nothing, and needs no rights, where all are there.
set -euo pipefail
list=$(dirname "${BASH_SOURCE[0]}")/packages.txt
# There itself, or provided by another package: NodeSource's nodejs holds npm and conflicts with Debian's.
here=" $(dpkg-query -W -f '${db:Status-Status} ${Package}, ${Provides}\n' 2>/dev/null |
    sed -n 's/^installed //p' | sed 's/([^)]*)//g' | tr -s ', \n' ' ') "
installed() { [[ $here == *" $1 "* ]]; }

missing=()
for kind in "$@"; do
    while read -r name; do
        first=${name%%|*}; other=${name##*|}  # "a|b": a, or where the system has no a, b
        if installed "$first" || installed "$other"; then continue; fi
        missing+=("$name")
    done < <(awk -v kind="$kind" '$1 == kind { print $2 }' "$list")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

command -v apt-get >/dev/null || {
    echo "nearpose: these Debian packages, or what your system calls them, are needed: ${missing[*]}" >&2
    exit 1
}
if [[ $(id -u) -eq 0 ]]; then as_root=()
elif sudo -n true 2>/dev/null; then as_root=(sudo -n)
else
    echo "nearpose: not root, and sudo asks for a password: run  sudo apt-get install ${missing[*]//|*/}  and then this command again" >&2
    exit 1
fi
echo "installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
names=()
for name in "${missing[@]}"; do
    first=${name%%|*}; other=${name##*|}
    if apt-cache show "$first" >/dev/null 2>&1; then names+=("$first"); else names+=("$other"); fi
done
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${names[@]}" >/dev/null
