#!/bin/sh
# Each folder of src/ includes only the folders src/FLOORS names for it; private headers
# (*_int.h) are included only in their own folder; base names are unique in the tree.
cd "$(dirname "$0")/../.." || exit 1
echo "1..3"

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
