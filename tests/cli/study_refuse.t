#!/bin/sh
# pms study: what cannot be rendered or read is left out or refused, and the report is written.
. "$(dirname "$0")/tap.sh"
. tests/cli/study_scene.sh
glass_ball 2000 "$T/s.pms"
cat >"$T/room.pms" <<'S'
#version 3.7;
global_settings { assumed_gamma 1 pms { gi on global_photons 500 } radiosity { count 5 } }
camera { location <0,3,-6> look_at 0 angle 40 }
light_source { <-4,7,3>, 1 }
plane { y, 0 pigment { rgb .8 } finish { ambient 0 diffuse 0.9 } }
S
cd "$T" || exit 1
size="-w 16 --height=12"
# has FILE PATTERN NAME
has() { grep -qE -- "$2" "$1"; ok $? "$3"; }
# study ARGUMENT...: a study that must not take long, nor end in a signal
study() { run timeout 100 "$PMS" study $size "$@"; }

# Ways to render that the plan refuses are left out, with its reason.
study room.pms --time=4s --effect=global_map=on
ok "$code" "a study of which some points are impossible"
why="--effect global_map=on is not possible here: path tracing finds that light itself"
has out "^paths  .* 16   $why$" "says which and why"
has out "^balanced " "and reports the rest"
has room.study/study.json "\"setting\": \"paths\", \"label\": \"64\", .*\"possible\": false, \"reason\": \"$why\"" \
    "so does the report as JSON"
has room.study/study.html "<td>paths 4</td><td>$why</td>" "and the page"
! grep -q "possible here" err
ok $? "it is no error"
[ "$(grep -c '^paths' room.study/runs.csv)" -eq 0 ] && [ "$(grep -c '^progressive' room.study/runs.csv)" -ge 1 ]
ok $? "no run of it is written down"
sed 's/, 1 }/, 1 area_light x, z, 2, 2 }/' room.pms >lit.pms
study lit.pms --time=4s --effect=irradiance_cache=on -o cache
[ "$code" -eq 0 ] && grep -q "path tracing" out cache/study.html
ok $? "the reference does without an effect that only some ways to render have"
fails 2 "progressive=on is not possible here" "nothing is studied if the scene itself is impossible" \
    "$PMS" study room.pms $size --time=1s --effect=progressive=on -o impossible
[ ! -e impossible ]
ok $? "and no folder made"

# What cannot be written ends the study, not the report.
study s.pms --time=2s -o full
sed -n '1,5p' full/runs.csv >some && mv some full/runs.csv
rm -rf full/study.* full/pictures/*
for value in 1 4 16 64; do mkdir "full/pictures/samples_$value.exr"; done
study s.pms --time=3s -o full
[ "$code" -eq 3 ] && grep -q "it is a directory" err && grep -q "as it stands; the error is" out
ok $? "a picture that cannot be written ends it (exit $code)"
[ -s full/study.html ] && [ -s full/study.json ]
ok $? "with a report, which misses no picture that was removed"

# Records that make no sense are of no run.
study s.pms --time=2s -o kept
cp -r kept odd
for field in inf -1 word; do
    sed "2,\$s/^\([^,]*,[^,]*,[^,]*,[^,]*\),[^,]*/\1,$field/" kept/runs.csv >odd/runs.csv
    study s.pms --time=1s -o odd
    [ "$code" -eq 0 ] && grep -q "^own,0,0,0,[0-9.e-]*,[0-9]" odd/runs.csv
    ok $? "seconds that are $field: rendered again (exit $code)"
done
for facts in "nan 1 nan" "2 -1 0" "2 1 -3" "inf 1 nan" "2"; do
    printf 'a method\n%s\n' "$facts" >kept/reference.txt
    fails 3 "reference.txt' is damaged" "a reference of $facts" "$PMS" study s.pms $size -o kept
done

# Paths are never cut.
long=$(awk 'BEGIN { while (i++ < 4090) printf "x"; print "" }')
fails 3 "path of the folder 'x+\.\.\.' is too long, 4090 bytes of at most" "a folder with a long name" \
    "$PMS" study s.pms $size -o "$long"
deep=$(awk 'BEGIN { while (i++ < 19) { while (j++ < 200) printf "y"; j = 0; printf "/" } print "z" }')
mkdir -p "${deep%/z}"
study s.pms --time=1s -o "$deep"
[ "$code" -eq 0 ] && [ -s "$deep/study.html" ]
ok $? "one of $(printf %s "$deep" | wc -c) bytes"
plan
