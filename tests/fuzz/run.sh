#!/bin/sh
# Fuzz the scene reader: tests/fuzz/run.sh [SECONDS]; 60 by default.  Needs clang with libFuzzer
# (Debian: clang libclang-rt-14-dev).  What it finds stays in build/fuzz/found.
set -eu
cd "$(dirname "$0")/../.."
seconds=${1:-60}
make -s MODE=fuzz CC=clang CXX=clang++ OPT_fuzz='-O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=undefined -DARENA_PARANOID' \
    WARN= CWARN= build/fuzz/libpms.a
flags=$(pkg-config --libs OpenEXR OpenColorIO libpng libjpeg)
clang -std=c17 -Isrc -O1 -g -fsanitize=address,undefined,fuzzer tests/fuzz/scene_fuzz.c build/fuzz/libpms.a \
    $flags -lembree3 -lm -lstdc++ -lpthread -o build/fuzz/scene_fuzz
mkdir -p build/fuzz/corpus build/fuzz/seeds build/fuzz/found
for file in tests/lang/*/*.pms tests/lang/*/*.inc; do
    cp "$file" "build/fuzz/seeds/$(echo "$file" | tr / _)"
done
# every word and mark of the language, for the mutations
sed -n 's/^X([A-Z_0-9]*, "\([a-z_0-9]*\)".*/"\1"/p' src/sdl/keywords.def >build/fuzz/words.dict
printf '"#"\n"\\"text\\""\n"<1,2,3>"\n"<="\n">="\n"!="\n"/*"\n"*/"\n"//"\n"{"\n"}"\n' >>build/fuzz/words.dict
exec build/fuzz/scene_fuzz -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -max_len=4096 \
    -dict=build/fuzz/words.dict -artifact_prefix=build/fuzz/found/ -print_final_stats=1 \
    build/fuzz/corpus build/fuzz/seeds
