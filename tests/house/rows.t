#!/bin/sh
# What the photon side must do is a list of rows, S1 to S16, in tests/physics/README.md.  Each row is
# named by a test, in a comment "Row S5: ...", and the table there says by which; S16 is a
# measurement, and named in tests/bench.
cd "$(dirname "$0")/../.." || exit 1
echo "1..3"
table=tests/physics/README.md
rows='1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16'

# Files that name a row, by base name; of the bench only what it measures.
named_in() {
    if [ "$1" -eq 16 ]; then
        grep -rlE "Row S$1:" tests/bench
    else
        grep -rlE "Row S$1:" tests --include='*_test.c' --include='*.t' | grep -v '^tests/house/'
    fi | sed 's,.*/,,; s,\.c$,,' | sort
}

# Files the table names for a row.
listed_for() {
    sed -n "s/^| S$1 |.*|\(.*\)|\$/\1/p" $table | grep -oE '`[a-z_.]+`' | tr -d '`' | sort
}

missing=
wrong=
for row in $rows; do
    named=$(named_in "$row")
    [ -n "$named" ] || missing="$missing S$row"
    [ "$named" = "$(listed_for "$row")" ] || wrong="$wrong S$row"
done
[ -z "$missing" ] && echo "ok 1 - every row is named by a test" ||
    { echo "not ok 1 - every row is named by a test"; echo "# no test names:$missing"; }
[ -z "$wrong" ] && echo "ok 2 - the table lists the tests that name a row" ||
    { echo "not ok 2 - the table lists the tests that name a row"
      echo "# tests/physics/README.md and the tests differ:$wrong"; }

# A row that does not exist, or one that is named in another form than the above.
bad=$(grep -rnE '\bRow S([0-9]+)[^:0-9]|\bRow S(0|1[7-9]|[2-9][0-9])|\brow S[0-9]|\* S[0-9]+[:,]' \
    tests --include='*_test.c' --include='*.t' | grep -v '^tests/house/')
[ -z "$bad" ] && echo "ok 3 - rows are named in one form" ||
    { echo "not ok 3 - rows are named in one form"; echo "$bad" | sed 's/^/# /'; }
