#!/bin/sh
# What `pms explain` prints: golden files for scenes that show what it says, the same on any number
# of threads; that what it expects is near what --measure finds; JSON; its refusals.
#
# To make the golden files anew:  PMS=build/release/pms tests/cli/explain.t remake
. "$(dirname "$0")/tap.sh"
golden=$ROOT/tests/cli/explain
explain() {
    name=$1
    shift
    if [ "$remake" ]; then
        "$PMS" explain "$@" -w 160 --height 120 >"$golden/$name.txt" || exit 1
        return
    fi
    for threads in 1 3; do
        run "$PMS" explain "$@" -w 160 --height 120 --threads $threads
        cmp -s "$T/out" "$golden/$name.txt" || diff "$golden/$name.txt" "$T/out" >"$T/err"
        ok $? "$name on $threads threads"
    done
}
remake=$1
explain caustic_glass scenes/caustic_glass.pms --all
explain cornell_box scenes/cornell_box.pms --gi
explain lens_fog scenes/lens_fog.pms --measure
explain many_lights scenes/many_lights.pms
explain csg_showpiece scenes/csg_showpiece.pms --measure --effect reflection=off,sky=off
[ "$remake" ] && exit
awk 'length > 100 { print FILENAME ": " $0; bad = 1 } END { exit bad }' "$golden"/*.txt >"$T/err"
ok $? "in 100 columns"

# near FILE FACTOR: every count that matters (5 % of the work) is within FACTOR of what it had.
cat >"$T/near.py" <<'P'
import json, sys
told = json.load(open(sys.argv[1]))
far = [w for w in told["work"] if max(w["expected"]["share"], w["had"]["share"]) >= 0.05 and not
       1 / float(sys.argv[2]) < w["expected"]["count"] / max(1, w["had"]["count"]) < float(sys.argv[2])]
for w in far:
    print(w, file=sys.stderr)
sums = [sum(w[when]["share"] for w in told["work"]) for when in ("expected", "had")]
sys.exit(bool(far) or len(told["work"]) < 3 or max(abs(s - 1) for s in sums) > 1e-6)
P
for scene in caustic_glass csg_showpiece lens_fog gems; do
    if ! command -v python3 >/dev/null; then
        skip "python3 is not installed"
        continue
    fi
    run "$PMS" explain scenes/$scene.pms -w 160 --height 120 --measure --json
    cp "$T/out" "$T/$scene.json"
    run python3 "$T/near.py" "$T/$scene.json" 1.3
    ok "$code" "what is expected of $scene is within 1.3 of what it had"
done

# The books of a watched render: what is seen is part of what is stored, and all of it is used.
cat >"$T/books.py" <<'P'
import json, sys
told = json.load(open(sys.argv[1]))
for light in told["caustic_photons"] + told["volume_photons"]:
    for when in ("expected", "had"):
        book = light[when]
        assert 0 <= book["seen"] <= book["stored"] and book["wasted"] == book["stored"] - book["seen"], book
    sent, seen = light["had"]["emitted"], light["had"]["seen"]
    assert sent == light["photons"], light
    assert sent == 0 or abs(light["expected"]["seen"] / seen - 1) < 0.25, light
P
if command -v python3 >/dev/null; then
    run python3 "$T/books.py" "$T/lens_fog.json"
    ok "$code" "photons seen and wasted"
    grep -q '"override": "photons { reflection off refraction off }"' "$T/lens_fog.json"
    ok $? "who forbade a light its photons"
fi

# A camera that sees nothing of what photons light wastes them all.
cat >"$T/blind.pms" <<'S'
#version 3.7;
global_settings { assumed_gamma 1 photons { count 2000 } }
camera { location <0,3,-5> look_at <0,9,-20> }
light_source { <1,5,-1>, 1 }
light_source { <3,5,-1>, 1 shadowless }
plane { y, 0 pigment { rgb 0.9 } }
sphere { <0,1,0>, 1 pigment { rgbt 1 } interior { ior 1.5 } photons { target refraction on } }
S
run "$PMS" explain "$T/blind.pms" -w 32 --height 24 --measure
[ "$(grep -cE '^light 1 .* 0 +[0-9.]+ k? +100%$' "$T/out")" -eq 2 ] &&
    grep -qE '^light 2 +shadowless: sends none \(.*blind.pms:5:1\)$' "$T/out"
ok $? "photons nobody sees are wasted; a light that sends none"
run "$PMS" explain "$T/blind.pms" -w 32 --height 24 --measure --progressive --passes=3
[ "$code" -eq 0 ] && grep -qE "^any picture +770 +[0-9]+% +770 .*camera rays$" "$T/out"
ok $? "--measure with passes"
run "$PMS" explain "$T/blind.pms" -w 32 --height 24 --aa 4
[ "$code" -eq 0 ] && grep -qE "^any picture +3.1 k .*camera rays$" "$T/out"
ok $? "samples of pixels count"
fails 2 "--measure wants --passes, --time or --error" "a render that does not end" \
    "$PMS" explain "$T/blind.pms" --measure --progressive
plan
