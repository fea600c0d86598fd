#!/bin/sh
# Each folder of src/ includes only the folders src/FLOORS names for it; private headers
# (*_int.h) are included only in their own folder; base names are unique in the tree; lines and files
# are no longer than people read them.
cd "$(dirname "$0")/../.." || exit 1
echo "1..5"

bad=$(grep -rnoE '^#include "[a-z]+/[^"]*"' src --include='*.[ch]' --include='*.cpp' | awk -F: '
    BEGIN {
        while ((getline line < "src/FLOORS") > 0) {
            n = split(line, w, /[: ]+/)
            for (i = 1; i <= n; i++) allowed[w[1] "/" w[i]] = 1
        }
    }
    { split($1, path, "/"); split($3, inc, /["\/]/)
      if (!((path[2] "/" inc[2]) in allowed)) print "# " $1 ":" $2 ": " path[2] " may not include " inc[2] }')
[ -z "$bad" ] && echo "ok 1 - floors" || { echo "not ok 1 - floors"; echo "$bad"; }

bad=$(grep -rnE '^#include "[a-z]+/[a-z0-9_]*_int\.h"' src tests --include='*.[ch]' --include='*.cpp' |
    awk -F: '{ split($1, path, "/"); split($3, inc, /["\/]/); if (path[1] != "src" || path[2] != inc[2]) print "# " $0 }')
[ -z "$bad" ] && echo "ok 2 - private headers" || { echo "not ok 2 - private headers"; echo "$bad"; }

bad=$(find src -name '*.c' -o -name '*.cpp' | sed 's,.*/,,; s,\.[a-z]*$,,' | sort | uniq -d | sed 's/^/# /')
[ -z "$bad" ] && echo "ok 3 - unique names" || { echo "not ok 3 - unique names"; echo "$bad"; }

bad=$(find src tests -name '*.[ch]' -o -name '*.cpp' | xargs awk 'length($0) > 100 { print "# " FILENAME ":" FNR }')
[ -z "$bad" ] && echo "ok 4 - lines of 100 columns" || { echo "not ok 4 - lines of 100 columns"; echo "$bad"; }

bad=$(find src tests -name '*.[ch]' -o -name '*.cpp' | xargs wc -l | awk '$1 > 800 && $2 != "total" { print "# " $0 }')
[ -z "$bad" ] && echo "ok 5 - files of 800 lines" || { echo "not ok 5 - files of 800 lines"; echo "$bad"; }
