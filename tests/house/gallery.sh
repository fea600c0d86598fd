#!/bin/sh
# Render the pictures of the README into scenes/gallery/: every scene small, the show scene larger.
# Names given as arguments render only those.  Each file must stay under 300 kB.
cd "$(dirname "$0")/../.." || exit 1
PMS=${PMS:-build/release/pms}
[ $# -gt 0 ] || set -- $(ls scenes/*.pms | sed 's,.*/,,; s,\.pms$,,')
mkdir -p scenes/gallery
for name in "$@"; do
    size="+W400 +H300"
    [ "$name" = caustic_glass ] && size="+W640 +H480"
    [ "$name" = cornell_box ] && size="+W300 +H300"
    aa="+AM2 +A0.05 +R3"
    [ "$name" = shapes ] && size="+W960 +H400"
    [ "$name" = macros_loops ] && aa=-A # its focal blur smooths enough
    [ "$name" = church_window ] && aa="+AM2 +A0.1 +R2" # fine lead all over the window
    picture=scenes/gallery/$name.png
    # shellcheck disable=SC2086
    "$PMS" "scenes/$name.pms" $size $aa -o "$picture" || exit 1
    bytes=$(wc -c <"$picture")
    echo "$picture: $bytes bytes"
    if [ "$bytes" -gt 300000 ]; then
        echo "$picture is larger than 300 kB" >&2
        exit 1
    fi
done
