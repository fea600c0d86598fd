#!/bin/sh
# Progressive renders: killed, interrupted, cut short and resumed, they come to the same bytes.
. "$(dirname "$0")/tap.sh"
cat >"$T/s.pms" <<'S'
#version 3.7;
global_settings { assumed_gamma 1 photons { count 20000 } }
#ifndef (GREEN) #declare GREEN = 0.2; #end
camera { location <0,3,-6> look_at <0,0.8,0> angle 40 aperture 0.1 focal_point 0 blur_samples 9 }
light_source { <-4,7,3>, 1 area_light <1,0,0>, <0,0,1>, 3, 3 jitter }
plane { y, 0 pigment { rgb <.8,GREEN,.8> } finish { ambient 0 diffuse 0.9 } }
sphere { <0,1,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }
  interior { ior 1.5 } photons { target refraction on collect off } }
S
P="$PMS $T/s.pms -w 64 --height=48 --progressive --layers=direct,caustic,Z"

# same A B NAME: two pictures and their states are the same bytes.
same() {
    cmp "$T/$1.exr.pmsstate" "$T/$2.exr.pmsstate" >"$T/err" 2>&1 &&
        "$PMS" compare "$T/$1.exr" "$T/$2.exr" --max-rmse=0 >"$T/out" 2>"$T/err"
    ok $? "$3"
}

run $P --passes=60 --threads=2 -o "$T/all.exr" --stats="$T/all.json"
[ "$code" -eq 0 ] && grep -q '"passes": 60, "passes_of_this_run": 60' "$T/all.json" &&
    grep -q '"caustic_radius": \[0\.[0-9]*, 0\.[0-9]*\]' "$T/all.json"
ok $? "60 passes, counted in the statistics"
grep -aq "pms.passes" "$T/all.exr"
ok $? "and in the header of the picture"

# kill -9 at random moments, each time going on with another number of threads.  What is left is a
# whole picture or none.
kills=${KILLS:-8} i=0 whole=0
while [ $i -lt "$kills" ]; do
    i=$((i + 1))
    $P --passes=60 --resume --threads=$((i % 3 + 1)) -o "$T/killed.exr" 2>/dev/null &
    sleep "0.$(od -An -N2 -tu2 /dev/urandom | awk '{ printf "%03d", $1 % 400 }')"
    kill -9 $! 2>/dev/null
    wait $! 2>/dev/null
    [ ! -e "$T/killed.exr" ] || "$PMS" compare "$T/killed.exr" "$T/all.exr" >/dev/null 2>&1 ||
        whole=1
done
ok $whole "killed $kills times: every picture left behind is whole"
run $P --passes=60 --resume --threads=2 -o "$T/killed.exr"
ok "$code" "resumed to the end"
same all killed "killed $kills times: the bytes of the uninterrupted render"

# Ctrl-C and SIGTERM.
for signal in INT TERM; do
    $P --resume -o "$T/$signal.exr" -o "$T/$signal.png" >"$T/out" 2>"$T/err" &
    pid=$!
    while [ ! -e "$T/$signal.png" ] && kill -0 $pid 2>/dev/null; do sleep 0.02; done
    sleep 0.1
    kill -$signal $pid
    wait $pid 2>/dev/null
    code=$?
    [ $code -eq 130 ] && grep -qE "interrupted; the picture is of [0-9]+ pass" "$T/err"
    ok $? "SIG$signal ends it with a picture (exit $code)"
    passes=$(sed -n 's/.*the picture is of \([0-9]*\) pass.*/\1/p' "$T/err")
    run $P --passes="${passes:-1}" -o "$T/fresh.exr"
    same $signal fresh "of the ${passes:-no} passes it says"
done
$P --threads=1 -o "$T/early.exr" >"$T/out" 2>"$T/err" &
pid=$!
kill -TERM $pid
wait $pid 2>/dev/null
code=$?
{ [ $code -eq 143 ] || [ $code -eq 130 ]; } && [ ! -e "$T/early.exr.pmsstate" ]
ok $? "SIGTERM before the first pass: no picture (exit $code)"

run $P --passes=1 -o "$T/one.exr"
[ "$code" -eq 0 ] && "$PMS" compare "$T/one.exr" "$T/all.exr" >/dev/null
ok $? "one pass is a picture"
run timeout 60 $P --time=0.3s -o "$T/timed.exr" --stats="$T/timed.json"
[ "$code" -eq 0 ] && grep -q '"passes": [1-9]' "$T/timed.json"
ok $? "a time limit ends it"
run timeout 60 $P --time=1d2h0.5m --passes=2 -o "$T/both.exr" --progress=json
[ "$code" -eq 0 ] && grep -q '"pass": 1, "passes": 2, "phase": ' "$T/err"
ok $? "whichever limit comes first; progress counts passes"
tail -n 1 "$T/err" | grep -qE '^\{"done": true, "passes": 2, "passes_of_this_run": 2, "seconds": [0-9.e-]+, "error": [0-9.e-]+, "error_bound": [0-9.e-]+, "files": \["[^"]*both.exr"\]\}$'
ok $? "and says how it ended"
run $P --passes=3 --resume -o "$T/both.exr"
[ "$code" -eq 0 ] &&
    grep -qE "^pms: 3 passes, 1 of them in this run, in [0-9.]+ s, error [0-9.]+ % \\(with 90 % confidence below [0-9.]+ %\\), saved in '.*both.exr'$" "$T/err"
ok $? "so it does in a log"
run $P --passes=4 --resume -o "$T/both.exr" --progress=none
[ "$code" -eq 0 ] && [ ! -s "$T/err" ]
ok $? "unless it is told not to"
run "$PMS" "$T/s.pms" --no-photons -w 32 --height=24 --progressive --passes=4 -o "$T/plain.exr"
[ "$code" -eq 0 ] && ! grep -v "^pms: 4 passes in" "$T/err"
ok $? "without photon maps"
run "$PMS" "$T/s.pms" --integrator=path --light-radius=0.5 -w 32 --height=24 --progressive --passes=4 -o "$T/path.exr"
ok "$code" "by paths"

# A state that is not there, not whole, or of another picture.
run $P --passes=2 --resume -o "$T/new.exr"
[ "$code" -eq 0 ] && grep -q "there is no '.*new.exr.pmsstate' to resume from" "$T/err"
ok $? "nothing to resume from: a warning, and a picture"
state=$T/new.exr.pmsstate
cp "$state" "$T/good"
for size in 0 5 40 300 90000; do
    head -c $size "$T/good" >"$state"
    fails 3 "pmsstate' is cut short, $size bytes of" "a state of $size bytes" $P --resume --passes=3 -o "$T/new.exr"
done
for at in 20 45 100 5000; do
    cp "$T/good" "$state"
    printf '\377\376' | dd of="$state" bs=1 seek=$at conv=notrunc 2>/dev/null
    fails 3 "damaged|cut short" "a state damaged at byte $at" $P --resume --passes=3 -o "$T/new.exr"
done
cp "$T/all.exr" "$state"
fails 3 "is not the state of a progressive render" "a picture for a state" $P --resume --passes=3 -o "$T/new.exr"
cp "$T/good" "$state"
fails 2 "is of another picture: size 64x48, not 64x50, seed 0, not 3" "another size and seed" $P --resume --passes=3 -o "$T/new.exr" --height=50 --seed=3
fails 2 "declarations changed" "another declaration" $P --resume --passes=3 -o "$T/new.exr" -d GREEN=0.3
fails 2 "samples_a_pass 1, not 2, .*gi off, not on" "other options" $P --resume --passes=3 -o "$T/new.exr" --aa=2 --gi
fails 2 "layers direct,caustic,Z, not none" "other layers" "$PMS" "$T/s.pms" -w 64 --height=48 --progressive --resume --passes=3 -o "$T/new.exr"
cp "$T/s.pms" "$T/old.pms"
echo "// and one line more" >>"$T/s.pms"
fails 2 "scene_text changed" "another text" $P --resume --passes=3 -o "$T/new.exr"
mv "$T/old.pms" "$T/s.pms"
cmp -s "$T/good" "$state"
ok $? "none of these touched the state"

# A disk that is full.
fails 3 "cannot write '.*full.exr.pmsstate'" "a full disk" sh -c "ulimit -f 60; exec $P --passes=9 -o '$T/full.exr'"
! ls "$T"/full* >/dev/null 2>&1
ok $? "leaves nothing half-written"
fails 3 "cannot write" "a folder that is not there" $P --passes=2 -o "$T/none/a.exr"

for option in --passes=3 --resume; do
    fails 2 "${option%=3} wants --progressive" "$option alone" "$PMS" "$T/s.pms" $option -o "$T/a.exr"
done
fails 2 "whole number from 1" "no passes" $P --passes=0 -o "$T/a.exr"
for time in 0 -1 5x 3mm m nan 1e30d 1s2m 5m5m 4m30x ''; do
    fails 2 "a time such as|wants T after it .*90s" "--time='$time'" $P --time="$time" -o "$T/a.exr"
done
fails 2 "\+A has no meaning" "+A" $P +A0.1 -o "$T/a.exr"
for error in 0% -1% 2 x% 200% nan% 1%%; do
    fails 2 "a percentage" "--error='$error'" "$PMS" "$T/s.pms" --error="$error" -o "$T/a.exr"
done

fails 2 "at most 65535 samples" "more samples than a pass can have" $P --passes=1 --aa=100000 -o "$T/a.exr"

# An error that is wanted: reached, or said not to be; whole pictures without a state; the same
# bytes on any number of threads.
for threads in 1 3; do
    run "$PMS" "$T/s.pms" -w 64 --height=48 --error=30% --threads=$threads -o "$T/error$threads.exr" --stats="$T/error.json"
done
[ "$code" -eq 0 ] && grep -qE "^pms: error below [0-9.]+ % after 4 passes; the plan: about [0-9]+ more of" "$T/err" &&
    grep -qE "^pms: [0-9]+ passes in .* s, error [0-9.]+ % \(with 90 % confidence below (30|[12][0-9.]*|[3-9]\.[0-9]+) %\), saved" "$T/err" &&
    [ ! -e "$T/error3.exr.pmsstate" ]
ok $? "an error wanted is reached"
"$PMS" compare "$T/error1.exr" "$T/error3.exr" --max-rmse=0 >/dev/null
ok $? "on any number of threads by the same bytes"
run $P --error=1% --passes=6 -o "$T/above.exr"
[ "$code" -eq 0 ] && grep -q "not sure to be below the 1 % wanted, saved" "$T/err"
ok $? "or it says that it is not"
run "$PMS" explain "$T/s.pms" --progressive --passes=100 --time=2m
[ "$code" -eq 0 ] && grep -q "^passes: 100, or what fits into 120 s; 1 sample a pixel in each, and these photons; the last gather radius is 0.488 of the first" "$T/out" &&
    grep -qE "^progressive +asked for on the command line" "$T/out"
ok $? "explain tells of passes"
plan
