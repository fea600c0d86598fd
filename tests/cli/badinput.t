#!/bin/sh
# Bad input: a clear message and the right exit code, never a crash, a hang or half a file.
. "$(dirname "$0")/tap.sh"

# scene NAME TEXT: write a scene file.
scene() { printf '%s\n' "$2" >"$T/$1.pms"; }
# bad NAME PATTERN TEXT: checking this scene must fail with exit 2 and say PATTERN.
bad() {
    scene "$1" "$3"
    fails 2 "$2" "$1" timeout 20 "$PMS" check "$T/$1.pms"
}

bad truncated "truncated.pms:[0-9]+:[0-9]+: error: the file ends" 'sphere { <0,0,0>, 1'
bad truncated-string "error: .*string" 'global_settings { assumed_gamma 1 } #declare S = "abc'
bad truncated-comment "error: .*comment" 'sphere { 0, 1 } /* what'
bad truncated-if "error: .*#end" '#if (1) sphere { 0, 1 }'
bad missing-include "nowhere.inc" '#include "nowhere.inc"'
printf '#include "b.inc"\n' >"$T/a.inc"; printf '#include "a.inc"\n' >"$T/b.inc"
bad include-cycle "includes itself|cycle|nest" '#include "a.inc"'
bad wrong-type "error: .*wants|wanted" 'sphere { "abc", 1 }'
bad unknown-word "did you mean .?sphere" 'shpere { 0, 1 }'
bad not-yet "not.*yet|yet" 'blob { threshold 1 sphere { 0, 1, 1 } }'
bad nan-transform "finite|not a number|nan|number" 'sphere { 0, 1 translate <1e308*10*0, 0, 0> }'
bad singular-matrix "singular|inverse" 'sphere { 0, 1 matrix <1,0,0, 1,0,0, 0,0,1, 0,0,0> }'
bad zero-plane "normal" 'plane { <0,0,0>, 1 }'
bad equal-ends "end|axis|same" 'cylinder { <1,1,1>, <1,1,1>, 1 }'
bad bad-index "index|range|vert" 'mesh2 { vertex_vectors { 3, 0, x, y } face_indices { 1, <0,1,7> } }'
bad endless-loop "token" '#while (1) #end'
bad deep-macro "nest" '#macro M() M() #end M()'
bad lookat "location" 'camera { location <1,2,3> look_at <1,2,3> } sphere { 0, 1 }'
bad illegal "error" 'sphere { 0, 1 } $$ @'

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
plan
