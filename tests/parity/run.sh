#!/bin/sh
# Compare pms with the installed povray: pictures, light of caustics, processor time.
#
#     PMS=build/release/pms tests/parity/run.sh [SCENE...]
#
# Pictures without caustics are compared at 320x240 by SSIM, without antialiasing and with +A.
# Caustics are compared by the light that falls on their receiver, with so many photons that the
# estimate of neither program is biased; shafts of light in media with many samples.  Times are
# whole runs of both programs as the scenes stand, from `pms validate`.  The last line is the
# verdict on the pictures; times are only reported, as they depend on what else the machine does.
set -u
cd "$(dirname "$0")/../.." || exit 1
PMS=${PMS:-build/release/pms}
case $PMS in /*) ;; *) PMS=$PWD/$PMS ;; esac
T=$(mktemp -d) || exit 1
trap 'rm -rf "$T"' EXIT
size="-w 320 --height 240"
photons=2000000
n=0 failed=0

# the receiver of each caustic among scenes/, in pixels of 320x240; else the whole picture
region() {
    case $1 in
    caustic_glass) echo 110,175,210,65 ;;
    coloured_glass | glass_sphere) echo 0,120,320,120 ;;
    gems) echo 40,165,170,75 ;; # not the stones: on ways inside them povray absorbs less
    magnifying_lens) echo 105,140,190,100 ;;
    many_lights) echo 60,125,220,100 ;;
    metal_ring) echo 0,100,320,140 ;;
    *) echo 0,0,320,240 ;;
    esac
}

# number NAME FILE: a member of the JSON object in a file
number() { sed -n "s/.*\"$1\": \([^,}]*\).*/\1/p" "$2"; }

verdict() {
    n=$((n + 1))
    if [ "$1" -eq 0 ]; then echo "ok $n - $2"; else
        echo "not ok $n - $2"
        failed=$((failed + 1))
    fi
}

at_least() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a >= b) }'; }

is_caustic() { grep -q 'photons *{ *target' "$1"; }
# pms { gi } makes another picture on purpose
is_own() { grep -q 'pms *{' "$1"; }
# photons in media take povray many minutes; it keeps none in the atmosphere
is_smoke() { grep -q 'photons *{.*media *[1-9]' "$1"; }
# media for which one of scenes/ asks samples: with few povray's shafts are banded
is_shafts() {
    case $1 in scenes/*) grep -q 'media *{.*samples' "$1" ;; *) false ;; esac
}

# table NAME FILE NOTE: one line of the table from validate's JSON
table() {
    awk -v name="$1" -v note="$3" -v s="$(number ssim "$2")" -v r="$(number rmse "$2")" \
        -v a="$(number pms_cpu_seconds "$2")" -v b="$(number povray_cpu_seconds "$2")" \
        -v c="$(number pms_wall_seconds "$2")" -v d="$(number povray_wall_seconds "$2")" 'BEGIN {
        printf "# %-22s %9.6f %9.6f %8.3f %8.3f %7.2f %8.3f %8.3f  %s\n",
            name, s, r, a, b, (a > 0 ? b / a : 0), c, d, note }'
}

# picture SCENE NOTE SWITCH...: a scene that has to look the same
picture() {
    scene=$1 note=$2
    name=$(basename "$scene" | sed 's/\.[a-z]*$//')
    shift 2
    if ! "$PMS" validate "$scene" $size --json "$@" >"$T/json" 2>"$T/err"; then
        sed 's/^/# /' "$T/err"
        verdict 1 "$name $*"
        return
    fi
    table "$name" "$T/json" "$note"
    case $note in caustic | own | shafts) return ;; esac
    at_least "$(number ssim "$T/json")" 0.98
    verdict $? "$name $*: SSIM $(number ssim "$T/json") is at least 0.98"
}

# light SCENE: a caustic whose light on the receiver has to be the same
light() {
    scene=$1
    name=$(basename "$scene" | sed 's/\.[a-z]*$//')
    rm -f "$T/json"
    sed "s/count *[0-9][0-9]*/count $photons/" "$scene" >"$T/$name.pms"
    povray "+I$T/$name.pms" "+O$T/povray.exr" +FE +W320 +H240 -D -A "+L$(dirname "$scene")" \
        +Lstdlib >/dev/null 2>"$T/err" </dev/null &&
        "$PMS" "$T/$name.pms" $size -L "$(dirname "$scene")" -o "$T/pms.exr" --progress none \
            2>"$T/err" &&
        "$PMS" compare "$T/pms.exr" "$T/povray.exr" --crop "$(region "$name")" --json \
            >"$T/json" 2>"$T/err" || sed 's/^/# /' "$T/err"
    a=$(number light_a "$T/json") b=$(number light_b "$T/json")
    ratio=$(awk -v a="${a:-0}" -v b="${b:-0}" 'BEGIN { printf "%.4f", (b > 0 ? a / b : 0) }')
    awk -v r="$ratio" 'BEGIN { exit !(r >= 0.97 && r <= 1.03) }'
    is_equal=$?
    verdict $is_equal "$name: light on the receiver is $ratio of povray's, within 3 %"
}

# shafts SCENE: light in media that has to look the same once povray takes many samples
shafts() {
    sed "s/samples *[0-9][0-9]*/samples 300/" "$1" >"$T/$(basename "$1")"
    picture "$T/$(basename "$1")" "" -A
}

heading() {
    printf '#\n# %-22s %9s %9s %8s %8s %7s %8s %8s\n' "$1" SSIM RMSE pms povray ratio pms povray
    printf '# %-22s %9s %9s %17s %7s %17s\n' "" "" "" "cpu seconds" "" "wall seconds"
}

command -v povray >/dev/null 2>&1 || { echo "1..0 # skip povray is not installed"; exit 0; }
if [ $# -gt 0 ]; then
    heading "named scenes"
    for scene in "$@"; do
        if is_caustic "$scene"; then
            picture "$scene" caustic
            light "$scene"
        elif is_shafts "$scene"; then
            picture "$scene" shafts -A
            shafts "$scene"
        else
            picture "$scene" ""
        fi
    done
    exit $((failed > 0))
fi

heading "small scenes"
for scene in tests/parity/*.pov; do
    if is_caustic "$scene"; then
        picture "$scene" caustic -A
        light "$scene"
    else
        picture "$scene" "" -A
        picture "$scene" "+A" +A0.1 +AM1 +R3 -J
        picture "$scene" "+AM2" +A0.1 +AM2 +R2 -J
    fi
done

heading "scenes/"
for scene in scenes/*.pms; do
    is_smoke "$scene" && continue
    note=
    is_caustic "$scene" && note=caustic
    is_own "$scene" && note=own
    is_shafts "$scene" && note=shafts
    picture "$scene" "$note" -A
    is_own "$scene" || awk -v a="$(number pms_cpu_seconds "$T/json")" \
        -v b="$(number povray_cpu_seconds "$T/json")" -v n="$scene" 'BEGIN { print b / a, n }' >>"$T/ratios"
    [ "$note" = caustic ] && light "$scene"
    [ "$note" = shafts ] && shafts "$scene"
done
awk '{ sum += log($1); if (NR == 1 || $1 < least) { least = $1; name = $2 } }
    END { printf "#\n# processor time of povray over that of pms, scenes/: geometric mean %.2f (to reach: 4), least %.2f (%s)\n",
        exp(sum / NR), least, name }' "$T/ratios"
echo "1..$n"
if [ "$failed" -eq 0 ]; then echo "# parity: $n comparisons hold"; else
    echo "# parity: $failed of $n comparisons fail"
    exit 1
fi
