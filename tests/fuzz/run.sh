#!/bin/sh
# Fuzz every reader of files: tests/fuzz/run.sh [SECONDS [TARGET...]]; 60 seconds each by
# default.  Needs clang with libFuzzer (Debian: clang libclang-rt-14-dev).  What it finds stays
# in build/fuzz/found.
set -eu
cd "$(dirname "$0")/../.."
seconds=${1:-60}
[ $# -gt 0 ] && shift
targets=${*:-$(ls tests/fuzz/*_fuzz.c | sed 's,.*/,,; s,_fuzz.c,,')}
make -s MODE=fuzz CC=clang CXX=clang++ OPT_fuzz='-O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=undefined -DARENA_PARANOID' \
    WARN= CWARN= build/fuzz/libpms.a
packages='OpenEXR OpenColorIO libpng libjpeg libtiff-4 freetype2'
flags="$(pkg-config --libs $packages) -lembree3 -lgif -lm -lstdc++ -lpthread"
# every word and mark of the language, for the mutations
sed -n 's/^X([A-Z_0-9]*, "\([a-z_0-9]*\)".*/"\1"/p' src/sdl/keywords.def >build/fuzz/scene.dict
printf '"#"\n"\\"text\\""\n"<1,2,3>"\n"<="\n">="\n"!="\n"/*"\n"*/"\n"//"\n"{"\n"}"\n' >>build/fuzz/scene.dict
export ASAN_OPTIONS=allocator_may_return_null=1
for target in $targets; do
    fuzzer=build/fuzz/${target}_fuzz
    clang -std=gnu17 -Isrc $(pkg-config --cflags $packages) -O1 -g \
        -fsanitize=address,undefined,fuzzer "tests/fuzz/${target}_fuzz.c" build/fuzz/libpms.a \
        $flags -o "$fuzzer"
    mkdir -p "build/fuzz/corpus/$target" "build/fuzz/seeds/$target" build/fuzz/found
    tests/fuzz/seeds.sh "$target" "build/fuzz/seeds/$target"
    dictionary=
    [ -f "build/fuzz/$target.dict" ] && dictionary=-dict=build/fuzz/$target.dict
    echo "fuzzing the $target reader for $seconds seconds"
    "$fuzzer" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=4096 \
        -max_len=4096 $dictionary -artifact_prefix=build/fuzz/found/ -print_final_stats=1 \
        -verbosity=0 "build/fuzz/corpus/$target" "build/fuzz/seeds/$target"
done
