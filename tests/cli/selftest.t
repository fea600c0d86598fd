#!/bin/sh
# pms selftest: every claim of the build holds; scenes look the same wherever they stand, and one that
# does not is found out.
. "$(dirname "$0")/tap.sh"

run "$PMS" selftest
[ "$code" -eq 0 ] && grep -q '^[0-9]* of [0-9]* claims hold' "$T/out" && ! grep -q '^FAIL' "$T/out"
ok $? "all claims hold (exit $code)"
[ "$(grep -c '^ok ' "$T/out")" -ge 25 ]
ok $? "and there are many"
[ ! -s "$T/err" ]
ok $? "without a word of warning"

run "$PMS" selftest --json --seed 3 -j 1
[ "$code" -eq 0 ] && [ "$(grep -c '"holds": true}' "$T/out")" -ge 25 ] &&
    ! grep -q '"holds": false' "$T/out" && tail -n 1 "$T/out" | grep -q '"failed": 0}$'
ok $? "as JSON, with another seed, on one thread"
if command -v python3 >/dev/null 2>&1; then
    python3 -c 'import json,sys; json.load(open(sys.argv[1]))' "$T/out" 2>"$T/err"
    ok $? "which is JSON"
else
    skip "python3 is not installed"
fi

cat >"$T/scene.pms" <<'S'
#version 3.7;
global_settings { assumed_gamma 1 photons { count 5000 } }
camera { location <0, 2, -5> look_at <0, 0.6, 0> right x up y }
light_source { <2, 4, -3>, 1 fade_distance 4 fade_power 2 }
plane { y, 0 pigment { checker rgb 0.8, rgb 0.3 } }
sphere { <0, 1, 0>, 1 pigment { rgbf 1 } interior { ior 1.5 } photons { target refraction on } }
#ifdef (Thin) box { <-2, -1, -2>, <2, Thin, 2> pigment { rgb x } } #end
S
run "$PMS" selftest "$T/scene.pms" -w 40
[ "$code" -eq 0 ] && [ "$(grep -cE '^(scaled|shifted|turned) ' "$T/out")" -eq 10 ] &&
    [ "$(grep -c 'same to the last bit' "$T/out")" -ge 3 ] && grep -q '^40x40 pixels' "$T/out"
ok $? "a scene looks the same wherever it stands"
run "$PMS" selftest "$T/scene.pms" -w 24 --height 16 --gi --json
[ "$code" -eq 0 ] && [ "$(grep -c '"holds": true}' "$T/out")" -eq 10 ] &&
    grep -q '"width": 24, "height": 16' "$T/out"
ok $? "as JSON, with indirect light"

# A skin thinner than places are known a million sizes away.
run "$PMS" selftest "$T/scene.pms" -w 40 -d Thin=1e-12
[ "$code" -eq 1 ] && grep -q 'the picture changes in [1-9]' "$T/err" &&
    grep -E '^shifted by 1e6' "$T/out" | grep -q ' changes$' &&
    grep -qE "worst at [0-9]+,[0-9]+: box \($T/scene.pms:7:" "$T/out"
ok $? "a scene that does not is found out, and the object (exit $code)"

fails 2 "one scene file or none" "two scenes" "$PMS" selftest "$T/scene.pms" "$T/scene.pms"
fails 3 "cannot open" "a scene that is not there" "$PMS" selftest "$T/none.pms"
echo 'sphere { 0 }' >"$T/bad.pms"
fails 2 "error:" "a scene that is none" "$PMS" selftest "$T/bad.pms"
plan
