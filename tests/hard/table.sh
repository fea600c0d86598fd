#!/bin/sh
# Run the hard cases with long counts, print them as a table, and write tests/hard/README.md.
# Arguments: the tests.  The exit code is 1 when a case fails.
#
# A test prints, for each case, "# hard: NAME: MEASURED (LIMIT)", and where povray can render it too,
# "# povray: NAME: VERDICT: MEASURED".  One that prints no rows is told of by the names of its tests.
# HARD_POVRAY= leaves povray out, and README.md as it is.
cd "$(dirname "$0")/../.." || exit 1
export HARD=long CMOCKA_MESSAGE_OUTPUT=TAP HARD_POVRAY="${HARD_POVRAY-1}"
[ "$HARD_POVRAY" ] || unset HARD_POVRAY
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# Opaque shapes and those of glass are the longest: side by side.
list=
for test; do
    case $test in
    *shape_cases_test) list="$list $test:opaque $test:glass" ;;
    *) list="$list $test:" ;;
    esac
done
# shellcheck disable=SC2086
printf '%s\n' $list | xargs -P 2 -I{} sh -c '
    test=${1%%:*} part=${1#*:}
    "$test" $part >"$2/$(basename "$test")$part.log" 2>&1
    [ $? -eq 0 ] || grep -q "^not ok" "$2/$(basename "$test")$part.log" ||
        echo "not ok 0 - $(basename "$test") ended early" >>"$2/$(basename "$test")$part.log"' \
    sh {} "$work"

awk -v readme="$work/README.md" -f tests/hard/table.awk "$work"/*.log
code=$?
[ -n "$HARD_POVRAY" ] && cp "$work/README.md" tests/hard/README.md
exit $code
