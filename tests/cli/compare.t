#!/bin/sh
# pms compare and pms validate: what a user types, what they see.
. "$(dirname "$0")/tap.sh"

cat >"$T/a.pms" <<'END'
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 0, -5> look_at 0 }
light_source { <5, 5, -5>, 1 }
sphere { 0, 1 pigment { rgb <1, .5, .2> } }
END
sed 's/<1, .5, .2>/<.9, .5, .2>/' "$T/a.pms" >"$T/b.pms"
size="-w 64 --height 48"
for s in a b; do
    "$PMS" "$T/$s.pms" $size -o "$T/$s.exr" -o "$T/$s.png" 2>"$T/err"
    ok $? "render $s"
done

# says PATTERN NAME COMMAND...: the command succeeds and its output has PATTERN.
says() {
    pattern=$1 name=$2
    shift 2
    run "$@"
    [ "$code" -eq 0 ] && grep -qE -- "$pattern" "$T/out"
    ok $? "$name"
}

says '^rmse +0$' "an image equals itself" "$PMS" compare "$T/a.exr" "$T/a.exr"
says '^ssim +1.0+$' "and its SSIM is 1" "$PMS" compare "$T/a.exr" "$T/a.exr"
says '^mae +0$' "and its mean absolute error" "$PMS" compare "$T/a.exr" "$T/a.exr"
says '^flip +0.0+$' "and nothing is seen to flip" "$PMS" compare "$T/a.exr" "$T/a.exr"
says '^psnr +inf' "and its PSNR is infinite" "$PMS" compare "$T/a.exr" "$T/a.exr"
says '^compared linear' "two EXRs are compared as light" "$PMS" compare "$T/a.exr" "$T/b.exr"
says '^compared display' "an EXR and a PNG as display values" "$PMS" compare "$T/a.exr" "$T/a.png"
says '^ssim +(1.0|0.99)' "the PNG shows what the EXR holds" \
    "$PMS" compare "$T/a.exr" "$T/a.png" --max-rmse 0.002 --min-ssim 0.999
says '"psnr": null' "JSON has no infinities" "$PMS" compare "$T/a.exr" "$T/a.exr" --json
says '^\{"space": "linear", "rmse": [0-9.e-]+, "mae": [0-9.e-]+, "relmse": .*"bad_b": 0.*\}$' "JSON is one object" \
    "$PMS" compare "$T/a.exr" "$T/b.exr" --json
says '^rmse' "thresholds that hold" "$PMS" compare "$T/a.exr" "$T/b.exr" --max-rmse 0.2 \
    --max-relmse 1 --min-psnr 10 --min-ssim 0.9

fails 1 "rmse is .*more than" "past --max-rmse" "$PMS" compare "$T/a.exr" "$T/b.exr" --max-rmse 1e-6
fails 1 "relmse is" "past --max-relmse" "$PMS" compare "$T/a.exr" "$T/b.exr" --max-relmse 1e-9
fails 1 "flip is .*more than" "past --max-flip" "$PMS" compare "$T/a.exr" "$T/b.exr" --max-flip 1e-6
fails 1 "psnr is .*less than" "past --min-psnr" "$PMS" compare "$T/a.exr" "$T/b.exr" --min-psnr 90
fails 1 "ssim is" "past --min-ssim" "$PMS" compare "$T/a.exr" "$T/b.exr" --min-ssim 1

for f in exr png; do
    run "$PMS" compare "$T/a.exr" "$T/b.exr" --diff "$T/diff.$f"
    [ "$code" -eq 0 ] && [ -s "$T/diff.$f" ]
    ok $? "difference image as $f"
done
for f in exr png; do
    run "$PMS" compare "$T/a.exr" "$T/b.exr" --flip-map "$T/flip.$f"
    [ "$code" -eq 0 ] && [ -s "$T/flip.$f" ]
    ok $? "map of visible differences as $f"
done
says '^mean' "the difference image can be read" "$PMS" compare "$T/diff.exr" "$T/diff.png"
if command -v exrheader >/dev/null 2>&1; then
    exrheader "$T/a.exr" >"$T/out" 2>&1 && grep -q 'chromaticities' "$T/out"
    ok $? "another reader reads the EXR"
else
    skip "exrheader is not installed"
fi

says '^rmse +0$' "a rectangle without difference" "$PMS" compare "$T/a.exr" "$T/b.exr" --crop 0,0,5,48
fails 2 "wants X,Y,W,H" "a rectangle that is none" "$PMS" compare "$T/a.exr" "$T/b.exr" --crop 1,2,3
fails 2 "does not lie" "a rectangle outside" "$PMS" compare "$T/a.exr" "$T/b.exr" --crop 60,0,5,5

for s in a b; do
    "$PMS" "$T/$s.pms" $size --layers error.noise -o "$T/${s}_noise.exr" 2>/dev/null
    "$PMS" "$T/$s.pms" $size --progressive --passes 32 --seed 5 --layers error.noise,error.bias \
        -o "$T/${s}_passes.exr" 2>/dev/null
done
"$PMS" "$T/a.pms" $size --progressive --passes 32 --seed 6 --layers error.noise,error.bias \
    -o "$T/other.exr" 2>/dev/null
says '^verdict +pass' "another seed passes the z-test" \
    "$PMS" compare "$T/a_passes.exr" "$T/other.exr" --z-test
grep -q 'noise of both images; bias subtracted' "$T/out" && grep -q '^pixels  *3072$' "$T/out"
ok $? "which says what it allows for"
fails 1 "differ by more than their noise" "another colour does not" \
    "$PMS" compare "$T/a_passes.exr" "$T/b_passes.exr" --z-test
grep -q '^verdict  fail$' "$T/out"
ok $? "and says so on standard output"
says '^worst +[^ ]+ at ([4-9]|1[0-9]),(1[0-9]|2[0-9])$' "the worst pixel is one of the whole picture" \
    "$PMS" compare "$T/a_passes.exr" "$T/other.exr" --z-test --crop 4,10,16,20
says 'noise of A alone; B counts as exact' "a picture without noise is exact" \
    "$PMS" compare "$T/a_noise.exr" "$T/a.exr" --z-test
says 'noise of B alone; A counts as exact' "on the other side too" \
    "$PMS" compare "$T/a.exr" "$T/a_noise.exr" --z-test
says '^verdict +pass' "cut to what is alike" \
    "$PMS" compare "$T/a_noise.exr" "$T/b_noise.exr" --z-test --crop 0,0,5,48
says '"z_test": \{"exact_a": false, .*"critical_z": [0-9.]+, "accepted": 1\.0*, .*"pass": true\}\}$' \
    "the z-test as JSON" "$PMS" compare "$T/a_noise.exr" "$T/a.exr" --z-test --json
fails 2 "pms SCENE --layers error.noise" "two pictures without noise" \
    "$PMS" compare "$T/a.exr" "$T/b.exr" --z-test
fails 2 "a PNG has neither" "the z-test of a PNG" \
    "$PMS" compare "$T/a_noise.exr" "$T/a.png" --z-test

"$PMS" "$T/a.pms" -w 32 --height 48 -o "$T/small.png" 2>/dev/null
fails 2 "differ in size" "images of two sizes" "$PMS" compare "$T/a.png" "$T/small.png"
fails 2 "wants two images" "one operand" "$PMS" compare "$T/a.png"
fails 2 "wants two images" "three operands" "$PMS" compare "$T/a.png" "$T/a.png" "$T/a.png"
fails 2 "max-rmse wants a number" "a threshold that is no number" \
    "$PMS" compare "$T/a.png" "$T/a.png" --max-rmse much
fails 2 "\.exr or \.png" "a difference image of unknown kind" \
    "$PMS" compare "$T/a.png" "$T/a.png" --diff "$T/diff.gif"
fails 3 "cannot open" "a missing image" "$PMS" compare "$T/a.png" "$T/none.png"
fails 3 "is a directory" "a folder as image" "$PMS" compare "$T" "$T/a.png"
fails 3 "neither an OpenEXR nor a PNG" "a scene as image" "$PMS" compare "$T/a.png" "$T/a.pms"
head -c 200 "$T/a.exr" >"$T/cut.exr"
fails 3 "cannot read" "a truncated EXR" "$PMS" compare "$T/cut.exr" "$T/a.exr"
head -c 60 "$T/a.png" >"$T/cut.png"
fails 3 "cannot read" "a truncated PNG" "$PMS" compare "$T/a.png" "$T/cut.png"
fails 3 "folder does not exist" "a difference image in a folder that is not there" \
    "$PMS" compare "$T/a.png" "$T/b.png" --diff "$T/none/d.png"

mkdir "$T/nothing" "$T/temp"
export TMPDIR="$T/temp"
fails 3 "povray is not installed" "validate without povray" \
    env PATH="$T/nothing" "$PMS" validate "$T/a.pms" $size
if command -v povray >/dev/null 2>&1; then
    says '^povray .* s cpu .* s wall' "validate measures both" \
        "$PMS" validate "$T/a.pms" $size --min-ssim 0.999 -o "$T/side.png"
    [ -s "$T/side.png" ]
    ok $? "and writes them side by side"
    says '"povray_cpu_seconds": [0-9]' "validate as JSON" "$PMS" validate "$T/a.pms" $size --json
    says '^ssim' "switches and declares reach povray" "$PMS" validate "$T/a.pms" +W40 +H30 +A0.1 \
        +AM2 +R2 -J "+L$T" -d N=3 -d 'S="some text"' --min-ssim 0.99
    fails 1 "rmse is" "validate past a threshold" \
        "$PMS" validate "$T/a.pms" $size --max-rmse 0
    # what only povray refuses is reported in its words
    echo '#ifdef (pms_version) sphere { 0, 1 } #else nonsense #end' >"$T/odd.pms"
    fails 3 "povray failed" "a scene povray refuses" "$PMS" validate "$T/odd.pms" $size
else
    skip "povray is not installed"
fi
fails 3 "cannot open" "validate a missing scene" "$PMS" validate "$T/none.pms"
fails 2 "wants one scene" "validate nothing" "$PMS" validate
[ -z "$(ls "$TMPDIR")" ]
ok $? "no temporary file is left"
plan
