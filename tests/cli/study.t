#!/bin/sh
# pms study: a report early, going on where it stopped, never mixing studies.
. "$(dirname "$0")/tap.sh"
. tests/cli/study_scene.sh
glass_ball 2000 "$T/s.pms"
cd "$T" || exit 1
size="-w 24 --height=18"
# has FILE PATTERN NAME
has() { grep -qE -- "$2" "$1"; ok $? "$3"; }
# lines FILE: how many there are
lines() { wc -l <"$1"; }

run timeout 100 "$PMS" study s.pms $size --time=4s
ok "$code" "a study in 4 seconds"
left=$(grep -c "were left out" out)
has out "^reference: progressive photon mapping, [0-9]+ passes; its own noise is" "says what it compares with"
has out "^samples .*times the time" "what halving the error takes"
has out "^ *5\.0 % " "and what to set"
has s.study/study.csv '^photons,8000,0,"8000","global_settings \{ photons \{ count 8000 \} \}",[123],[0-9.]+,' \
    "settings, values and how to set them as CSV"
awk -F, 'NR == 1 { n = NF } { gsub(/"[^"]*"/, ""); if (NF != n) exit 1 }' s.study/study.csv
ok $? "each line of it has as many fields"
python=$(command -v python3)
if [ -n "$python" ]; then
    "$python" -c 'import json, sys
s = json.load(open("s.study/study.json"))
assert s["width"] == 24 and len(s["points"]) > 5 and len(s["recommended"]) == 3
assert s["reference"]["noise"] > 0 and all(p["seconds"] > 0 for p in s["points"])' 2>err
    ok $? "JSON that others read"
else
    skip "python3 is not installed"
fi
has s.study/study.html "</html>" "a page"
! grep -qE '(src|href)="(http|//)|@import|<script' s.study/study.html
ok $? "that needs no network"
if command -v gnuplot >/dev/null; then
    [ "$(grep -c '<svg' s.study/study.html)" -ge 2 ] && grep -q "relative\|error" s.study/study.svg
    ok $? "with plots"
else
    skip "gnuplot is not installed"
fi
before=$(lines s.study/runs.csv)
cp s.study/reference.exr ref.exr
run timeout 100 "$PMS" study s.pms $size --time=15s
after=$(lines s.study/runs.csv)
[ "$code" -eq 0 ] && [ "$after" -ge $((before + left)) ] && cmp -s ref.exr s.study/reference.exr
ok $? "the same command goes on: $before and then $after lines, and the same reference"
[ "$(cut -d, -f1-4 s.study/runs.csv | sort | uniq -d | wc -l)" -eq 0 ]
ok $? "nothing was rendered twice"

# Ctrl-C: when there is something to report, it is reported.
big="-w 96 --height=72"
"$PMS" study s.pms $big --time=1h --seed=3 -o stop >out 2>err &
pid=$!
while [ ! -e stop/runs.csv ] && kill -0 $pid 2>/dev/null; do
    [ -e stop/reference_a.pmsstate ] && kill -INT $pid 2>/dev/null && break
    sleep 0.05
done
wait $pid
code=$?
[ $code -eq 130 ] && grep -q "interrupted" err
ok $? "interrupted in the reference (exit $code)"
"$PMS" study s.pms $big --time=12s --seed=3 -o stop >out 2>err &
pid=$!
while [ ! -e stop/runs.csv ] && kill -0 $pid 2>/dev/null; do sleep 0.05; done
sleep 0.5
kill -INT $pid
wait $pid
code=$?
[ $code -eq 130 ] && grep -qE "the report in 'stop' is of [0-9]+ runs of [0-9]+" err && [ -s stop/study.html ]
ok $? "and in the runs: a report all the same (exit $code)"
done=$(lines stop/runs.csv)
run timeout 100 "$PMS" study s.pms $big --time=3s --seed=3 -o stop
[ "$code" -eq 0 ] && [ "$(lines stop/runs.csv)" -gt "$done" ]
ok $? "from which it goes on"
printf 'photons,4' >>stop/runs.csv
run timeout 100 "$PMS" study s.pms $big --time=1s --seed=3 -o stop
ok "$code" "a line cut short by a crash is no harm"

# What does not belong together is not mixed.
fails 2 "holds the study of another picture: size 24x18, not 32x18" "another size" "$PMS" study s.pms -w 32 --height=18
fails 2 "another picture: seed" "another seed" "$PMS" study s.pms $big --seed=4 -o stop
sed -i 's/diffuse 0.9/diffuse 0.8/' s.pms
fails 2 "another picture: scene_text changed" "a changed scene" "$PMS" study s.pms $size
run timeout 100 "$PMS" study s.pms $size --time=2s -o given --reference=ref.exr
[ "$code" -eq 0 ] && grep -q "reference: a picture that was given; its own noise is unknown" out
ok $? "a reference that was given"
fails 2 "another picture: reference changed" "is part of what the study is of" "$PMS" study s.pms $size -o given

fails 2 "is of 24x18 pixels, the study of 8x8" "a reference of another size" \
    "$PMS" study s.pms -w 8 --height=8 -o bad --reference=ref.exr
run "$PMS" s.pms $size -o ref.png
fails 2 "holds display values" "a reference for displays" "$PMS" study s.pms $size -o bad2 --reference=ref.png
fails 3 "cannot open 'none.exr'" "no reference there" "$PMS" study s.pms $size -o bad3 --reference=none.exr
fails 2 "--time wants a time" "a bad time" "$PMS" study s.pms --time=soon
fails 2 "one folder, got 2" "two folders" "$PMS" study s.pms -o a -o b
fails 2 "wants one scene file" "no scene" "$PMS" study
fails 3 "cannot make the folder" "a folder that cannot be" "$PMS" study s.pms $size -o none/where
# The examples of the page, as they stand there.
ln -s "$ROOT/scenes" "$ROOT/stdlib" .
mkdir -p pms-bin
ln -s "$PMS" pms-bin/pms
awk '/^\.Bd -literal/ { inside = 1; next } /^\.Ed/ { inside = 0 } inside' "$ROOT/man/pms-study.1" >examples
while read -r line; do
    run timeout 100 env PATH="$T/pms-bin:$PATH" sh -c "$line -L stdlib"
    ok "$code" "pms-study(1): $line"
done <examples
[ "$(wc -l <examples)" -ge 4 ]
ok $? "there are examples"

mkdir -p bin
for tool in sh rm; do ln -sf "$(command -v $tool)" bin/; done
run env PATH="$T/bin" "$PMS" study s.pms $size --time=1s -o given --reference=ref.exr
[ "$code" -eq 0 ] && grep -q "gnuplot is not installed.*gnuplot-nox" err && grep -q "<table>" given/study.html
ok $? "without gnuplot: tables, and what to install"
run timeout 100 "$PMS" study s.pms $size --time=1s -o given --reference=ref.exr --json --progress=json
[ "$code" -eq 0 ] && grep -q '"recommended": \[' out && ! grep -q '"percent": 100' err
ok $? "JSON to standard output; progress is never done too early"
# A folder's name is no part of what gnuplot reads.
evil=$(printf 'a\nset print "PWNED"; print "owned"\n#')
run timeout 100 "$PMS" study s.pms $size --time=2s -o "$evil"
[ "$code" -eq 0 ] && [ ! -e PWNED ] && [ ! -e "$evil/PWNED" ] && grep -q "<svg" "$evil/study.html"
ok $? "a folder named like a command of gnuplot's"
run timeout 100 "$PMS" study s.pms $size --time=2s --output=-dash
[ "$code" -eq 0 ] && grep -q "<svg" ./-dash/study.html
ok $? "or like an option"
plan
