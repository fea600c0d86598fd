#!/bin/sh
# pms render --replay: the story of a pixel, and the warning that names one.
. "$(dirname "$0")/tap.sh"
cat >"$T/s.pms" <<'S'
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0,0,-3> look_at 0 }
light_source { <2,3,-4>, 1 }
sphere { 0, 1 pigment { rgbt <1,.5,.2,.5> } finish { reflection 0.2 } interior { ior 1.5 } }
plane { z, 3 pigment { rgb 1 } }
S
sed 's/^plane.*/plane { z, 3 pigment { rgb 1e30 } finish { ambient 1e30 } }/' "$T/s.pms" >"$T/bad.pms"

cd "$T" || exit 1
run "$PMS" s.pms -w 40 --height 30 --replay 20,15
[ "$code" -eq 0 ] && grep -qE 'camera ray, level 1, from <0, 0, -3> along' out &&
    grep -qE 'enters sphere \(s.pms:5:1\) at t 2\.00' out && grep -q 'reflected ray' out &&
    grep -qE '^1 sample, [0-9]+ rays$' out && grep -qE '^pixel 20,15: [0-9.]+ ' out
ok $? "a pixel tells what its rays met"
ls ./*.png ./*.exr >/dev/null 2>&1
[ $? -ne 0 ]
ok $? "and no picture is written"
run "$PMS" s.pms -w 40 --height 30 --replay 20,15 --aa 4
[ "$code" -eq 0 ] && [ "$(grep -c '^  sample ' out)" -eq 4 ]
ok $? "all samples of it"
run "$PMS" s.pms -w 40 --height 30 --replay 40,15
[ "$code" -eq 2 ] && grep -q 'does not lie in the picture of 40x30' err
ok $? "a pixel outside is refused"
run "$PMS" s.pms --replay 1
[ "$code" -eq 2 ] && grep -q -- '--replay wants X,Y' err
ok $? "X,Y is wanted"
run "$PMS" s.pms -w 40 --height 30 --replay 4294967297,1
[ "$code" -eq 2 ] && grep -q -- '--replay wants X,Y' err
ok $? "and no more digits than a picture has"
run "$PMS" s.pms -w 40 --height 30 --replay 1,1 -o x.png
[ "$code" -eq 2 ] && grep -q 'writes no files' err && [ ! -e x.png ]
ok $? "no file is written, and none may be asked for"
run "$PMS" s.pms -w 40 --height 30 --replay 1,1 --progressive --passes 2
[ "$code" -eq 2 ] && grep -q 'one pass' err
ok $? "and one pass"

run "$PMS" bad.pms -w 40 --height 30 -o b.png
[ "$code" -eq 0 ] && grep -q 'bad.pms:6:1: warning: light that is no number came from here' err &&
    [ "$(grep -c 'no number' err)" -eq 1 ]
ok $? "a sample that is no number is told of once"
pixel=$(sed -n 's/.*--replay \([0-9,]*\) tells.*/\1/p' err)
run "$PMS" bad.pms -w 40 --height 30 --replay "$pixel"
[ "$code" -eq 0 ] && grep -q 'NOT A NUMBER' out && grep -q 'not a number, left out' out &&
    [ ! -s err ]
ok $? "and the pixel that is named shows it"
plan
