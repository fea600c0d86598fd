#!/bin/sh
# Render the examples of shapes that come with povray, by both programs, and compare the pictures.
#
#     PMS=build/release/pms tests/parity/examples.sh [SCENE...]
#
# At 160x120 without antialiasing.  A scene that pms cannot read yet is named with what it lacks; of
# the others each has to be alike to an SSIM of 0.97.  SPDX-License-Identifier: Apache-2.0
set -u
PMS=${PMS:-build/release/pms}
folder=/usr/share/doc/povray/examples/objects
includes=/usr/share/povray-3.7/include
T=$(mktemp -d) || exit 1
trap 'rm -rf "$T"' EXIT
command -v povray >/dev/null 2>&1 || { echo "1..0 # skip povray is not installed"; exit 0; }
[ $# -gt 0 ] || set -- "$folder"/*.pov "$folder"/csg/*.pov "$folder"/quartic/*.pov

# number NAME FILE: a member of the JSON object in a file
number() { sed -n "s/.*\"$1\": \([^,}]*\).*/\1/p" "$2"; }

# lacks FILE: the first thing that pms says it has not
lacks() { sed -n 's/.*error: //p' "$1" | head -1 | cut -c1-80; }

# The surface of this one has folds finer than its precision, between which povray sees through; with
# a higher one its picture becomes what that of pms is with either.
finer() {
    case $1 in
    fractal4.pov)
        sed 's/precision 20/precision 2000/' "$folder/$1" >"$T/$1"
        echo "$T/$1"
        ;;
    *) echo "$folder/$1" ;;
    esac
}

n=0 alike=0 failed=0 unread=0
printf '%-22s %9s %8s %8s\n' scene SSIM pms povray
for scene in "$@"; do
    n=$((n + 1))
    name=${scene#"$folder"/}
    if ! "$PMS" check "$scene" -L "$includes" >"$T/out" 2>"$T/err"; then
        unread=$((unread + 1))
        printf '%-22s not read: %s\n' "$name" "$(lacks "$T/err")"
        continue
    fi
    if ! timeout 600 "$PMS" validate "$scene" -L "$includes" -w 160 --height 120 --json \
        >"$T/json" 2>"$T/err" </dev/null; then
        failed=$((failed + 1))
        printf '%-22s fails: %s\n' "$name" "$(lacks "$T/err")"
        continue
    fi
    ssim=$(number ssim "$T/json") verdict=
    other=$(finer "$name")
    if [ "$other" != "$folder/$name" ]; then
        verdict="(SSIM $ssim as it stands; this is with a higher precision)"
        "$PMS" validate "$other" -L "$includes" -w 160 --height 120 --json >"$T/json" 2>"$T/err"
        ssim=$(number ssim "$T/json")
    fi
    if awk -v s="$ssim" 'BEGIN { exit !(s >= 0.97) }'; then
        alike=$((alike + 1))
    else
        failed=$((failed + 1)) verdict="differs $verdict"
    fi
    printf '%-22s %9.6f %7.2fs %7.2fs  %s\n' "$name" "$ssim" "$(number pms_cpu_seconds "$T/json")" \
        "$(number povray_cpu_seconds "$T/json")" "$verdict"
done
echo "$n scenes: $alike alike, $failed not, $unread not read yet"
[ "$failed" -eq 0 ]
