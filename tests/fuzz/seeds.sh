#!/bin/sh
# Put the files a fuzzer starts from into a folder: tests/fuzz/seeds.sh TARGET FOLDER.
target=$1 folder=$2
case $target in
scene)
    for file in tests/lang/*/*.pms tests/lang/*/*.inc; do
        cp "$file" "$folder/$(echo "$file" | tr / _)"
    done
    ;;
exr | png)
    pms=build/release/pms
    [ -x $pms ] || exit 0
    echo 'sphere { 0, 1 pigment { rgb 1 } } light_source { <5, 5, -5>, 1 }' >"$folder/seed.pms"
    for size in 1 17; do
        $pms "$folder/seed.pms" -w $size --height $size -o "$folder/$size.$target" || exit 1
        $pms "$folder/seed.pms" -w $size --height $size --bits 16 --half --alpha --layers N,Z \
            -o "$folder/more_$size.$target" || exit 1
    done
    rm "$folder/seed.pms"
    ;;
bitmap) # the first byte is the kind, as bitmap.h counts them
    { printf '\004'; cat tests/lang/image_file/small.pgm; } >"$folder/pnm"
    printf '\005\0\0\012\0\0\0\0\0\0\0\0\0\002\0\002\0\030\0\203abc' >"$folder/tga"
    printf '\010#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\nabcdefgh' >"$folder/hdr"
    ;;
font)
    for file in /usr/share/povray-3.*/include/*.ttf; do
        if [ -f "$file" ]; then cp "$file" "$folder"; fi
    done
    ;;
esac
