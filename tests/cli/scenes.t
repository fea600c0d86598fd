#!/bin/sh
# Every scene in scenes/ passes `pms check`; every include in stdlib/ can be read alone and twice;
# the installed povray accepts them all, too.
cd "$(dirname "$0")/../.." || exit 1
PMS=${PMS:-build/release/pms}
scenes=$(ls scenes/*.pms)
includes=$(ls stdlib/*.inc)
count=$(echo "$scenes" "$includes" | wc -w)
echo "1..$((2 * count))"
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
n=0

# report STATUS NAME LOG: one TAP line, the log behind a failure
report() {
    n=$((n + 1))
    if [ "$1" -eq 0 ]; then
        echo "ok $n - $2"
    else
        echo "not ok $n - $2"
        sed 's/^/# /' "$3"
    fi
}

# lone INCLUDE: make a scene that reads it twice
lone() {
    base=$(basename "$1")
    printf '#version 3.7;\n#include "%s"\n#include "%s"\n' "$base" "$base" >"$work/$base.pov"
    printf 'global_settings { assumed_gamma 1 }\nsphere { 0, 1 pigment { rgb 1 } }\n' >>"$work/$base.pov"
    echo "$work/$base.pov"
}

for scene in $scenes; do
    "$PMS" check "$scene" >"$work/log" 2>&1
    report $? "pms reads $scene" "$work/log"
done
for include in $includes; do
    "$PMS" check "$(lone "$include")" -L stdlib >"$work/log" 2>&1
    report $? "pms reads $include" "$work/log"
done

# accept FILE NAME: one tiny render by povray, without photons' share of the time
accept() {
    if command -v povray >/dev/null 2>&1; then
        povray "+I$1" +Lstdlib +Lscenes +W16 +H12 -A -D -F >"$work/log" 2>&1
        report $? "povray reads $2" "$work/log"
    else
        n=$((n + 1))
        echo "ok $n - povray reads $2 # skip povray is not installed"
    fi
}

for scene in $scenes; do
    accept "$scene" "$scene"
done
for include in $includes; do
    accept "$(lone "$include")" "$include"
done
