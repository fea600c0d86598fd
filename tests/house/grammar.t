#!/bin/sh
# The words of the grammar are the reserved words pms has, and the reverse: all but the words of
# pms { } and `unofficial`, which are ordinary identifiers outside their places, and words that
# are read and dropped in one place while what they stand for elsewhere is still missing.
cd "$(dirname "$0")/../.." || exit 1
echo "1..3"
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
sed -n 's/^X([A-Z_0-9]*, "\([a-z_0-9]*\)", true)/\1/p' src/sdl/keywords.def | sort -u >"$tmp/has"
sed 's/(\*[^*]*\*)//g' grammar/pms.ebnf | awk '
    /^[a-z_]+ *=/ { rule = $1 }
    rule !~ /^(pms_|letter|digit|hex|number$|escape)/' |
    grep -oE '"[a-z_][a-z_0-9]*"' | tr -d '"' | sort -u >"$tmp/grammar"

check() {
    [ -z "$2" ] && echo "ok $1" || { echo "not ok $1"; echo "$2" | sed 's/^/# /'; }
}
check "1 - every word pms has is in the grammar" "$(comm -23 "$tmp/has" "$tmp/grammar")"
check "2 - every word of the grammar is one pms has" \
    "$(comm -13 "$tmp/has" "$tmp/grammar" | grep -vxE 'unofficial|normal|subsurface|load_file|save_file')"

folders=$(for folder in tests/lang/*/; do basename "$folder"; done)
rules=$(sed -n 's/^\([a-z_0-9]*\) *=.*/\1/p' grammar/pms.ebnf)
check "3 - every folder of tests/lang is a rule of the grammar" \
    "$(echo "$folders" | grep -vx library | grep -vxF "$rules")"
