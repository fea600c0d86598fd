#!/bin/sh
# Row S1: first the photon maps, then the eye pass; both give the same bytes on any number of
# threads.  Row S11: nothing is simulated that the scene does not call for.
. "$(dirname "$0")/tap.sh"
scene=scenes/caustic_glass.pms

for threads in 1 2 7; do
    run "$PMS" $scene -w 80 --height 60 --threads $threads --gi -o "$T/$threads.exr" --stats="$T/$threads.json" \
        --layers=direct,caustic,indirect,Z,N
    ok "$code" "renders on $threads threads"
    grep -o '"hash": "[0-9a-f]*"' "$T/$threads.json" >"$T/$threads.hash"
    sed -n '/"counters"/,/"features"/p' "$T/$threads.json" >"$T/$threads.counts"
done
for threads in 2 7; do
    run "$PMS" compare "$T/1.exr" "$T/$threads.exr" --max-rmse=0
    ok "$code" "pixels of 1 and $threads threads are the same"
    cmp -s "$T/1.hash" "$T/$threads.hash"
    ok $? "photon maps of 1 and $threads threads are the same"
    cmp -s "$T/1.counts" "$T/$threads.counts"
    ok $? "and so is all that was counted"
done
[ "$(grep -cvF '"0000000000000000"' "$T/1.hash")" -eq 2 ]
ok $? "both photon maps were made"
run "$PMS" $scene -w 80 --height 60 --seed 2 --gi -o "$T/other.exr" --stats="$T/other.json"
grep -o '"hash": "[0-9a-f]*"' "$T/other.json" >"$T/other.hash"
[ "$code" -eq 0 ] && [ "$(sort "$T/1.hash" "$T/other.hash" | uniq -u | wc -l)" -eq 4 ]
ok $? "another seed gives other maps"

cat >"$T/matte.pms" <<'S'
#version 3.7;
global_settings { assumed_gamma 1 photons { count 1000 } }
camera { location <0,1,-5> look_at 0 }
light_source { <2,3,-4>, 1 }
sphere { 0, 1 pigment { rgb <1,.5,.2> } }
plane { y, -1 pigment { checker rgb 1, rgb .2 } }
S
run "$PMS" explain "$T/matte.pms" --all
[ "$code" -eq 0 ] && grep -q "no photon pass" "$T/out" && grep -qE "^caustic_map +no surface reflects or transmits" "$T/out"
ok $? "explain: no specular surface, no photon pass"
run "$PMS" explain --json "$T/matte.pms"
[ "$code" -eq 0 ] && { ! command -v python3 >/dev/null || python3 -m json.tool <"$T/out" >/dev/null; }
ok $? "explain --json is JSON"
run "$PMS" "$T/matte.pms" -w 40 --height 30 -o "$T/m.exr" --stats="$T/m.json"
[ "$code" -eq 0 ] && grep -q '"photons.emitted": 0' "$T/m.json" &&
    grep -q '"rays.shadow_filter_walks": 0' "$T/m.json" && ! grep -q '"rays.shadow": 0' "$T/m.json"
ok $? "statistics: 0 photons, 0 shadow-filter walks, some shadow rays"
plan
