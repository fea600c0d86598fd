#!/bin/sh
# Bad input: a clear message and the right exit code, never a crash, a hang or half a file.
. "$(dirname "$0")/tap.sh"

# scene NAME TEXT: write a scene file.
scene() { printf '%s\n' "$2" >"$T/$1.pms"; }
# bad NAME PATTERN TEXT: checking this scene must fail with exit 2, and the line of the error, behind
# the file's name and the place, must say PATTERN.
bad() {
    scene "$1" "$3"
    fails 2 "[0-9]: error: .*($2)" "$1" timeout 20 "$PMS" check "$T/$1.pms"
}

bad truncated "the file ends" 'sphere { <0,0,0>, 1'
bad truncated-string "string" 'global_settings { assumed_gamma 1 } #declare S = "abc'
bad truncated-comment "comment" 'sphere { 0, 1 } /* what'
bad truncated-if "#end" '#if (1) sphere { 0, 1 }'
bad missing-include "nowhere.inc" '#include "nowhere.inc"'
printf '#include "b.inc"\n' >"$T/a.inc"; printf '#include "a.inc"\n' >"$T/b.inc"
bad include-cycle "includes itself" '#include "a.inc"'
bad wrong-type "wants|wanted" 'sphere { "abc", 1 }'
bad unknown-word "did you mean .?sphere" 'shpere { 0, 1 }'
bad not-yet "has no .light_group. yet" 'light_group { sphere { 0, 1 } }'
bad nan-transform "finite" 'sphere { 0, 1 translate <1e308*10*0, 0, 0> }'
bad singular-matrix "singular" 'sphere { 0, 1 matrix <1,0,0, 1,0,0, 0,0,1, 0,0,0> }'
bad zero-plane "normal of a plane is 0" 'plane { <0,0,0>, 1 }'
bad equal-ends "ends of a cylinder" 'cylinder { <1,1,1>, <1,1,1>, 1 }'
bad bad-index "out of range" 'mesh2 { vertex_vectors { 3, 0, x, y } face_indices { 1, <0,1,7> } }'
bad endless-loop "tokens evaluated" '#while (1) #end'
bad deep-macro "nest too deep" '#macro M() M() #end M()'
bad lookat "look_at is where the camera is" 'camera { location <1,2,3> look_at <1,2,3> } sphere { 0, 1 }'
bad illegal "no meaning" 'sphere { 0, 1 } $$ @'

head -c 4096 /dev/urandom >"$T/garbage.pms"
run timeout 20 "$PMS" check "$T/garbage.pms"
[ "$code" -eq 2 ] && grep -q error "$T/err"
ok $? "binary garbage (exit $code)"
fails 3 "cannot open.*nowhere.pms" "missing scene" "$PMS" check "$T/nowhere.pms"
fails 3 "is a directory" "a folder as scene" "$PMS" check "$T"
: >"$T/empty.pms"
run "$PMS" "$T/empty.pms" -w 16 --height 16 -o "$T/empty.png"
[ "$code" -eq 0 ] && [ -s "$T/empty.png" ] && grep -q "warning" "$T/err"
ok $? "an empty scene renders its background, with a warning"

for text in 'sphere { 0, -1 pigment { rgb 1 } }' 'triangle { 0, 0, x }' 'sphere { 0, 1 scale 0 }'; do
    printf 'camera { location -5*z } light_source { 9, 1 }\n%s\n' "$text" >"$T/odd.pms"
    run timeout 20 "$PMS" "$T/odd.pms" -w 16 --height 16 -o "$T/odd.png"
    [ "$code" -eq 0 ] && grep -q "warning" "$T/err"
    ok $? "accepted with a warning: $text"
done

# nest COUNT: glass balls in each other
nest() {
    printf 'camera { location -9*z } light_source { 9, 1 }\n'
    printf '#declare I = 0; #while (I < %d) sphere { 0, 1 + 0.05*I pigment { rgbt 1 }' "$1"
    printf ' interior { ior 1.1 } } #declare I = I + 1; #end\n'
}
for count in 30 40; do
    nest $count >"$T/nest.pms"
    run "$PMS" "$T/nest.pms" -w 16 --height 16 -o "$T/nest.png"
    warnings=$(grep -c "warning: more than 32 bodies" "$T/err")
    [ "$code" -eq 0 ] && [ "$warnings" -eq $((count > 32)) ]
    ok $? "$count bodies in each other: $warnings warnings"
done

scene good 'camera { location -5*z } light_source { 9, 1 } sphere { 0, 1 pigment { rgb 1 } }'
(ulimit -f 0; "$PMS" "$T/good.pms" -w 64 --height 64 -o "$T/full.exr" 2>"$T/err")
code=$?
[ "$code" -eq 3 ] && ! ls "$T"/full.exr* >/dev/null 2>&1
ok $? "a full disk leaves no file (exit $code)"
(ulimit -f 8; "$PMS" "$T/good.pms" -w 640 --height 480 -o "$T/full.exr" 2>"$T/err")
code=$?
[ "$code" -eq 3 ] && ! ls "$T"/full.exr* >/dev/null 2>&1
ok $? "a disk that fills up leaves no file (exit $code)"

"$PMS" "$T/good.pms" -w 4000 --height 4000 --aa=64 -o "$T/cut.exr" 2>"$T/err" &
pid=$!
sleep 0.5
kill -INT $pid
wait $pid
code=$?
[ "$code" -eq 130 ] && ! ls "$T"/cut.exr* >/dev/null 2>&1
ok $? "interrupted: exit 130 and no file (exit $code)"
scene forever '#while (1) #end'
"$PMS" check "$T/forever.pms" --max-tokens=1000000000000 2>"$T/err" &
pid=$!
sleep 0.5
kill -INT $pid
(sleep 10; kill -KILL $pid) 2>/dev/null &
watch=$!
wait $pid
code=$?
kill $watch 2>/dev/null
[ "$code" -eq 130 ] && grep -q interrupted "$T/err"
ok $? "interrupted while reading: exit 130 (exit $code)"

# Between two mirrors of glass each ray makes two, so a single sample takes for ever.
scene mirrors '#version 3.7; global_settings { assumed_gamma 1 max_trace_level 256 adc_bailout 0 }
camera { location -5*z } light_source { <3, 5, -5>, 1 }
#declare M = texture { pigment { rgbt 1 } finish { reflection 1 } }
sphere { 0, 1 texture { M } interior { ior 1.5 } } plane { z, 3 texture { M } } plane { -z, 9 texture { M } }'
"$PMS" "$T/mirrors.pms" -w 8 --height 8 -o "$T/mirrors.png" 2>"$T/err" &
pid=$!
sleep 0.5
kill -INT $pid
(sleep 10; kill -KILL $pid) 2>/dev/null &
watch=$!
wait $pid
code=$?
kill $watch 2>/dev/null
[ "$code" -eq 130 ] && ! ls "$T"/mirrors.png* >/dev/null 2>&1
ok $? "interrupted within a sample: exit 130 and no file (exit $code)"

if [ -c /dev/full ]; then
    "$PMS" explain "$T/good.pms" >/dev/full 2>"$T/err"
    code=$?
    [ "$code" -eq 3 ] && grep -q "cannot write" "$T/err"
    ok $? "a full standard output is an error (exit $code)"
else
    skip "no /dev/full here"
fi

mkfifo "$T/pipe.png"
fails 3 "not a regular file" "a pipe as picture" "$PMS" "$T/good.pms" -w 8 --height 8 -o "$T/pipe.png"
[ -p "$T/pipe.png" ]
ok $? "the pipe is still there"
fails 2 "NAME=VALUE" "a declaration without a name" "$PMS" check "$T/good.pms" Declare=1x=3
plan
