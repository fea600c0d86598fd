#!/bin/sh
# Path tracing on the command line: its options, what explain says, the warning about lights
# without a size, the layers, and the same bytes on any number of threads.
. "$(dirname "$0")/tap.sh"
cat >"$T/s.pms" <<'S'
#version 3.7;
global_settings { assumed_gamma 1 photons { count 1000 } }
camera { location <0,1,-5> look_at <0,0.8,0> }
light_source { <2,3,-4>, 0.8 }
light_source { <-2,4,-1>, 0.5 area_light x, z, 3, 3 jitter adaptive 1 }
plane { y, 0 pigment { checker rgb 0.9, rgb 0.3 } finish { ambient 0 diffuse 0.8 } }
sphere { <0,1,0>, 1 pigment { rgbt 1 } interior { ior 1.5 }
  finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel } conserve_energy } photons { target refraction on } }
S

fails 2 "--integrator wants photons or path, got 'paths'" "unknown integrator" \
    "$PMS" --integrator=paths "$T/s.pms"
fails 2 "--light-radius wants a number from 0" "negative radius" \
    "$PMS" --integrator=path --light-radius=-1 "$T/s.pms"

run "$PMS" explain --integrator=path "$T/s.pms" --all
[ "$code" -eq 0 ] && grep -qE "^path_tracing +asked for" "$T/out" &&
    grep -qE "^caustic_map +path tracing finds that light itself" "$T/out" &&
    grep -qE "^path_caustics .*MISSING are those of 1 without" "$T/out" && grep -q "no photon pass" "$T/out"
ok $? "explain: no maps, and whose caustics are missing"
run "$PMS" explain --integrator=path --light-radius=0.1 "$T/s.pms"
[ "$code" -eq 0 ] && grep -qE "^path_caustics +lights with a size: 2" "$T/out"
ok $? "explain: with a radius none are"
run "$PMS" explain --integrator=photons "$T/s.pms"
[ "$code" -eq 0 ] && grep -q " path_tracing," "$T/out" && grep -qE "^caustic_map +photons" "$T/out"
ok $? "explain: photons are the default"

for threads in 1 3; do
    run "$PMS" "$T/s.pms" -w 48 --height 36 --aa 4 --integrator=path --gi --threads $threads \
        --layers=direct,caustic,indirect -o "$T/$threads.exr" --stats="$T/$threads.json"
    [ "$code" -eq 0 ] && grep -q '"photons.emitted": 0' "$T/$threads.json" &&
        ! grep -q '"rays.diffuse": 0' "$T/$threads.json"
    ok $? "renders on $threads threads, without photons"
done
[ "$(grep -c "warning: paths cannot meet 1 light without an area" "$T/err")" -eq 1 ]
ok $? "one warning about the light without a size"
run "$PMS" compare "$T/1.exr" "$T/3.exr" --max-rmse=0
ok "$code" "pixels of 1 and 3 threads are the same"
grep -q "path, light_radius 0" "$T/1.exr"
ok $? "the EXR header names the integrator"
run "$PMS" "$T/s.pms" -w 8 --height 6 --integrator=path --light-radius=0.5 --no-photons -o "$T/r.exr"
[ "$code" -eq 0 ] && [ ! -s "$T/err" ]
ok $? "no warning with a radius"
plan
