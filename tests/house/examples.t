#!/bin/sh
# The scenes shown in the language's man page are whole scenes: each renders.
cd "$(dirname "$0")/../.." || exit 1
PMS=${PMS:-build/release/pms}
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
awk -v dir="$tmp" '
    /^\.Bd -literal/ { inside = 1; n++; next }
    /^\.Ed/ { inside = 0 }
    inside { print > (dir "/" n ".pms") }
    END { print n }' man/pms.5 >"$tmp/count"
count=$(cat "$tmp/count")
echo "1..$count"
i=1
while [ "$i" -le "$count" ]; do
    if message=$($PMS "$tmp/$i.pms" -o "$tmp/$i.png" +W32 +H24 2>&1) && [ -s "$tmp/$i.png" ]; then
        echo "ok $i - example $i of pms(5) renders"
    else
        echo "not ok $i - example $i of pms(5) renders"
        echo "$message" | sed 's/^/# /'
    fi
    i=$((i + 1))
done
