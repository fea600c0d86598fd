#!/bin/sh
# Usage: help, version, options and switches, good and bad.
. "$(dirname "$0")/tap.sh"
cat >"$T/s.pms" <<'S'
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0,0,-3> look_at 0 }
light_source { <2,3,-4>, 1 }
sphere { 0, 1 pigment { rgb <1,.5,.2> } }
S

run "$PMS" --help
[ "$code" -eq 0 ] && grep -q "usage: pms" "$T/out" && [ ! -s "$T/err" ]
ok $? "--help goes to standard output"
for command in check explain validate; do
    run "$PMS" $command --help
    [ "$code" -eq 0 ] && grep -q "usage: pms $command" "$T/out"
    ok $? "$command --help"
done
grep -qE -- '--output=FILE .*side by side' "$T/out"
ok $? "validate says what its -o writes"
run "$PMS" --version
[ "$code" -eq 0 ] && grep -q "^pms [0-9]" "$T/out"
ok $? "--version"

# What was asked for stands beside what is sent.
sed 's/assumed_gamma 1/& photons { count 900 } pms { global_photons 700 }/
    s/^sphere.*/plane { y, -1 pigment { rgb 1 } } sphere { 0, 1 pigment { rgbf 1 } interior { ior 1.5 } }/' "$T/s.pms" >"$T/p.pms"
run "$PMS" explain "$T/p.pms" --gi
[ "$code" -eq 0 ] && grep -qE '^caustic photons: count 900 asked for, [0-9]+ to send$' "$T/out" &&
    grep -q '^global photons: global_photons 700 asked for, 700 to send$' "$T/out"
ok $? "explain: photons asked for and sent"
sed 's/count 900/spacing 0.25/' "$T/p.pms" >"$T/q.pms"
run "$PMS" explain "$T/q.pms"
[ "$code" -eq 0 ] && grep -qE '^caustic photons: spacing 0.25 asked for, [0-9]+ to send$' "$T/out"
ok $? "explain: by spacing"
run "$PMS" explain "$T/p.pms" --gi --json
[ "$code" -eq 0 ] &&
    grep -qF '"caustic_asked": {"count": 900, "spacing": null, "global_photons": null}' "$T/out" &&
    grep -qF '"global_asked": {"count": null, "spacing": null, "global_photons": 700}' "$T/out"
ok $? "explain --json: the same"

fails 2 "wants one scene file" "no scene" "$PMS"
fails 2 "wants one scene file, got 2: 'a.pms', 'b.pms'" "two scenes" "$PMS" a.pms b.pms
fails 2 "no option --wdith.*did you mean --width" "a slip of the fingers" "$PMS" --wdith=3 "$T/s.pms"
fails 2 "no option --integrater; did you mean --integrator\?" "and with a value behind it" \
    "$PMS" --integrater path "$T/s.pms"
fails 2 "no option -width; did you mean --width\?" "a long name behind one dash" "$PMS" -width 3 "$T/s.pms"
fails 2 "no option -widht; did you mean --width\?" "and one misspelled" "$PMS" -widht 3 "$T/s.pms"
fails 2 "no option -outptu; did you mean --output\?" "which is no name of a file either" "$PMS" -outptu=a.png "$T/s.pms"
fails 2 "no option -declrae; did you mean --declare\?" "nor a declaration" "$PMS" -declrae=N=3 "$T/s.pms"
(cd "$T" && run "$PMS" s.pms -w8 --height=6 -oeffect.exr -dN=2 && [ "$code" -eq 0 ] && [ -s effect.exr ])
ok $? "a value joined to a letter is one"
for order in "--aa=4 +A0.1" "+A --aa=4"; do
    fails 2 "\+A has no meaning with --aa, which takes 4 samples" "two ways to sample pixels: $order" \
        "$PMS" $order "$T/s.pms" -o "$T/a.exr"
done
run "$PMS" +A -A --aa=2 "$T/s.pms" -w 8 --height=6 -o "$T/a.exr"
ok "$code" "-A takes +A back"
fails 2 "no command 'rendr'; did you mean render\?" "a misspelled command" "$PMS" rendr "$T/s.pms"
fails 2 "no command 'chekc'; did you mean check\?" "a misspelled command alone" "$PMS" chekc
cp "$T/s.pms" "$T/explan"
(cd "$T" && run "$PMS" explan -w 8 --height=6 -o slip.png && [ "$code" -eq 0 ])
ok $? "but not if a scene is called so"
fails 2 "^pms: error: --gi wants its value joined to it by =; did you mean --gi=gather\?$" \
    "a value that wants =" "$PMS" --gi gather "$T/s.pms"
fails 2 "wants one scene file, got 2" "a scene behind --gi is none" "$PMS" --gi "$T/s.pms" "$T/explan"
fails 2 "^pms: error: --gi= wants HOW after it" "= and nothing" "$PMS" --gi= "$T/s.pms"
fails 2 "^pms: error: --layers= wants LIST after it .*direct,caustic" "an empty list" \
    "$PMS" --layers= "$T/s.pms" -o "$T/a.exr"
fails 2 "^pms: error: --layers wants LIST after it" "an empty word" "$PMS" --layers "" "$T/s.pms"
fails 2 "^pms: error: -w wants N after it" "a letter, = and nothing" "$PMS" -w= "$T/s.pms"
fails 2 "-Q, --quality wants a whole number from 0 to 11, got '12'" "a letter's value" "$PMS" -Q 12 "$T/s.pms"
fails 2 "no option -x" "unknown letter" "$PMS" -x "$T/s.pms"
fails 2 "does not know the switch \+ZZ" "unknown switch" "$PMS" +ZZ "$T/s.pms"
fails 2 "whole number from 1 to 65536" "zero-size image" "$PMS" --width=0 "$T/s.pms"
fails 2 "whole number from 1 to 65536" "zero-size image by switch" "$PMS" +H0 "$T/s.pms"
fails 2 "whole number" "width is not a number" "$PMS" --width=wide "$T/s.pms"
fails 2 "wants N after it" "argument missing" "$PMS" "$T/s.pms" --width
fails 2 "takes no value" "flag with a value" "$PMS" --half=1 "$T/s.pms"
fails 2 "NAME=VALUE" "bad declaration" "$PMS" --declare=3 "$T/s.pms"
fails 2 "no layer 'depth'" "unknown layer" "$PMS" --layers=depth "$T/s.pms"
fails 2 "cannot tell the format" "unknown extension" "$PMS" -o "$T/a.bmp" "$T/s.pms"
fails 3 "cannot write" "output folder missing" "$PMS" -o "$T/none/a.png" "$T/s.pms"
fails 3 "is a directory" "output is a folder" sh -c "mkdir -p '$T/d.png'; exec '$PMS' -o '$T/d.png' '$T/s.pms'"
fails 2 "no display|display" "unknown display" "$PMS" --display=nowhere -w 8 --height=8 -o "$T/a.png" "$T/s.pms"
fails 3 "nowhere.ocio" "missing colour configuration" "$PMS" --ocio="$T/nowhere.ocio" -w 8 --height=8 -o "$T/a.png" "$T/s.pms"

# What would fail after the picture is made is said before.
early() {
    name=$1
    shift
    run "$PMS" "$@" --progress=json -w 64 --height=48 -o "$T/a.png" "$T/s.pms"
    [ "$code" -ne 0 ] && [ -s "$T/err" ] && ! grep -q '"phase"' "$T/err"
    ok $? "before rendering: $name"
}
early "unknown display" --display=nowhere
early "unknown view" --view=nowhere
early "missing colour configuration" --ocio="$T/nowhere.ocio"
early "bad number of bits" --bits=12
early "statistics in a missing folder" --stats="$T/none/stats.json"
early "statistics and picture in one file" --stats="$T/./a.png"
early "errors and picture in one file" --error-map="$T/a.png"
early "a picture twice" -o "$T/../$(basename "$T")/a.png"
early "statistics over the scene" --stats="$T/s.pms"
[ ! -e "$T/a.png" ] && ! ls "$T"/*.part* >/dev/null 2>&1
ok $? "nothing half-written is left"

run "$PMS" "+I$T/s.pms" "+O$T/pov" +W32 +H24 +A0.3 +R2 -J +WT2 -D Declare=K=3
[ "$code" -eq 0 ] && [ -s "$T/pov.png" ]
ok $? "POV-Ray's command line"
run "$PMS" "$T/s.pms" -w 32 --height 24 --aa 4 -o "$T/a.exr" -o "$T/a.png" --stats=- --progress=json
[ "$code" -eq 0 ] && [ -s "$T/a.exr" ] && [ -s "$T/a.png" ] && grep -q '"film.pixels": 768' "$T/out" &&
    grep -q '"percent"' "$T/err" && ! grep -q '"percent": 100' "$T/err"
ok $? "two outputs, statistics, progress that never says 100 early"
(cd "$T" && run "$PMS" s.pms -w 8 --height 6 && [ "$code" -eq 0 ] && [ -s s.exr ] && [ -s s.png ])
ok $? "default output names"
run "$PMS" "$T/s.pms" -w=8 --height=6 -o="$T/eq.png"
[ "$code" -eq 0 ] && [ -s "$T/eq.png" ]
ok $? "= behind a letter"
run "$PMS" "$T/s.pms" -w 8 --height 6 --progress=line -o "$T/a.png"
[ "$code" -eq 0 ] && grep -qE '^eye [0-9]+ %' "$T/err" && ! tr '\r\033' '~~' <"$T/err" | grep -q '~'
ok $? "lines of progress in a log have no escape codes"
run "$PMS" "$T/s.pms" -w 8 --height 6 --bits=16 --half --layers=direct,caustic,indirect,Z,N,albedo -o "$T/h.exr" -o "$T/h.png"
[ "$code" -eq 0 ]
ok $? "half, 16 bits, layers"
run "$PMS" "$T/s.pms" -w 8 --height 6 --layers=Z -o "$T/l.png"
[ "$code" -eq 0 ] && grep -q "warning: --layers" "$T/err"
ok $? "layers without an EXR file: a warning"
plan
