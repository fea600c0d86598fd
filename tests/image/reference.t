#!/bin/sh
# Pictures against references: each NAME.pms here beside its NAME.exr.  The first line of the
# scene gives the options, the tolerance and what the picture guards:
#     // image: --width=64 --height=48; max-rmse 0.002; what it guards
# `reference.t --update NAME...` renders new references (a commit of their own, with the reason).
. "$(dirname "$0")/../cli/tap.sh"

field() { sed -n "1s,^// image: *,,p" "$1" | cut -d';' -f"$2" | sed 's/^ *//'; }

if [ "$1" = --update ]; then
    shift
    for name in "$@"; do
        # The header keeps the command line: no path of this machine in it.
        # shellcheck disable=SC2046
        "${PMS#"$ROOT"/}" "tests/image/$name.pms" $(field "tests/image/$name.pms" 1) --half -o "tests/image/$name.exr"
    done
    exit
fi

for scene in tests/image/*.pms; do
    [ -e "$scene" ] || break
    name=$(basename "$scene" .pms)
    limit=$(field "$scene" 2 | sed 's/max-rmse *//')
    # shellcheck disable=SC2046
    run "$PMS" "$scene" $(field "$scene" 1) -o "$T/$name.exr"
    if [ "$code" -eq 0 ]; then
        run "$PMS" compare "$T/$name.exr" "tests/image/$name.exr" --max-rmse="$limit"
    fi
    ok "$code" "$name: $(field "$scene" 3)"
done
plan
