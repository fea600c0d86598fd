#!/bin/sh
# The page of a study, as a browser without a network shows it.  Set SHOT to keep the screenshot.
. "$(dirname "$0")/tap.sh"
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome)
if [ -z "$browser" ] || ! command -v gnuplot >/dev/null; then
    skip "chromium or gnuplot is not installed: make check-study"
    plan
    exit 0
fi
. tests/cli/study_scene.sh
glass_ball 4000 "$T/s.pms"
width=1200 height=5000
run timeout 100 "$PMS" study "$T/s.pms" -w 48 --height=36 --time=8s -o "$T/study"
ok "$code" "a study"
# show FILE OPTION...: let the browser have the page, its output in FILE
show() {
    file=$1
    shift
    timeout 100 "$browser" --headless --no-sandbox --disable-gpu --hide-scrollbars \
        --user-data-dir="$T/browser" --host-resolver-rules="MAP * ~NOTFOUND" \
        --window-size=$width,$height "$@" "file://$T/study/study.html" >"$file" 2>"$T/err"
}
show "$T/dom" --dump-dom
[ "$(grep -c '<svg' "$T/dom")" -ge 2 ] && [ "$(grep -o '<path' "$T/dom" | wc -l)" -gt 40 ]
ok $? "the browser finds the plots in it"
[ "$(grep -o '<img [^>]*base64' "$T/dom" | wc -l)" -ge 3 ]
ok $? "and pictures"
show "$T/out" --screenshot="$T/shot.png"
[ -s "$T/shot.png" ]
ok $? "a screenshot"
[ -z "$SHOT" ] || cp "$T/shot.png" "$ROOT/$SHOT"

# light X,Y,W,H: the mean of that part of the screenshot
light() {
    "$PMS" compare "$T/shot.png" "$T/shot.png" --crop="$1" 2>"$T/err" | sed -n 's/^means *\([^ ]*\) .*/\1/p'
}
# between LOW VALUE HIGH
between() { awk -v a="$1" -v x="$2" -v b="$3" 'BEGIN { exit !(x != "" && x >= a && x <= b) }'; }
between 1 "$(light 1160,0,40,$height)" 1 && between 1 "$(light 0,0,40,$height)" 1
ok $? "nothing runs over the margins"
between 0.7 "$(light 40,0,1120,1200)" 0.995
ok $? "there is text on white"
between 0.3 "$(light 40,0,1120,$height)" 0.98
ok $? "and something to see below"
plan
