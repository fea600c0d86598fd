#!/bin/sh
# --effect: effects forced on and off, what is refused and why, and that off means off.
. "$(dirname "$0")/tap.sh"
head='#version 3.7;
camera { location <0,1,-5> look_at <0,0.8,0> SCENE_BLUR }
sky_sphere { pigment { rgb <0.3,0.4,0.6> } }
light_source { <2,4,-3>, 0.8 }
light_source { <-2,4,-1>, 0.5 area_light x, z, 3, 3 }
plane { y, 0 pigment { checker rgb 0.9, rgb 0.3 } finish { ambient 0 diffuse 0.8 } }
sphere { <-1,0.6,0>, 0.6 pigment { rgb <0.9,0.5,0.2> } finish { ambient 0 emission 0.4 specular 0.5 reflection 0.3 } }
'
glass='sphere { <0.6,0.7,0>, 0.7 pigment { rgbf <0.9,1,0.9,1> } finish { ambient 0 diffuse 0 reflection 0.1 }
  interior { ior 1.5 dispersion 1.05 dispersion_samples 5 fade_distance 1 fade_power 1 fade_color <0.2,0.7,0.4> }'
target='photons { target refraction on reflection on }'
air='fog { distance 60 rgb 0.5 }
rainbow { direction -z angle 40 width 5 distance 1e4 color_map { [0 rgbt 1] [1 rgbt <1,0,0,0.5>] } }
media { scattering { 1, 0.02 } intervals 1 samples 2 }'
settings='global_settings { assumed_gamma 1 PHOTONS pms { gi on global_photons 3000 } }'
write() {
    echo "$settings" | sed "s/PHOTONS/$1/"
    echo "$head" | sed "s/SCENE_BLUR/$2/"
    echo "$glass $3 }"
    echo "$4"
}
write 'photons { count 2000 media 10 }' 'aperture 0.1 blur_samples 9 focal_point <0,1,0>' "$target" "$air" >"$T/all.pms"
write 'photons { count 2000 }' '' "$target" '' >"$T/clear.pms"
write '' '' "$target" '' >"$T/dark.pms"
write '' '' '' '' >"$T/plain.pms"
size="-w 16 --height 12 --threads 2"

# shows SCENE OPTIONS EFFECT VALUE: the effect is on (true) or off (false).
shows() {
    run "$PMS" "$1" $size $2 -o "$T/a.exr" --stats=-
    [ "$code" -eq 0 ] && grep -q "\"$3\": $4" "$T/out"
}

run "$PMS" "$T/all.pms" $size -o "$T/on.exr" --stats="$T/on.json"
for effect in caustic_map global_map final_gathering irradiance_cache emission_photons sky_light \
    transparent_shadows reflection refraction dispersion absorption area_lights highlights \
    focal_blur sky_sphere lights shadows volume_map media fog rainbow; do
    grep -q "\"$effect\": true" "$T/on.json" &&
        shows "$T/all.pms" "--effect $effect=off" $effect false &&
        ! cmp -s "$T/on.exr" "$T/a.exr"
    ok $? "$effect=off leaves it out of the picture"
done
for effect in path_tracing path_caustics; do
    shows "$T/clear.pms" "--effect path_tracing=on" $effect true
    ok $? "$effect=on"
done
shows "$T/clear.pms" "--integrator=path --effect path_caustics=off" path_caustics false
ok $? "path_caustics=off"

# none SCENE OPTIONS COUNTER...: the counters stay at 0.
none() {
    scene=$1 options=$2
    shift 2
    run "$PMS" "$T/$scene.pms" $size $options -o "$T/a.exr" --stats=-
    for counter in "$@"; do
        [ "$code" -eq 0 ] && grep -q "\"$counter\": 0,\$" "$T/out"
        ok $? "$options: $counter is 0"
    done
}
none all "--effect shadows=off" rays.shadow
none all "--effect lights=off,caustics=off,gi=off" rays.shadow rays.photon
none all "--effect reflection=off" rays.reflected
none all "--effect refraction=off" rays.refracted
none all "--effect caustics=off" photons.caustic rays.photon_caustic gathers.caustic_photons
none all "--effect indirect=off" photons.global gather_rays.points
none all "--effect volume_map=off" photons.volume rays.photon_volume gathers.volume_photons
none all "--effect cache=off" irradiance_cache.records
none all "--effect gather=off" gather_rays.points
none all "--effect transparent_shadows=off" rays.shadow_filter_walks
none all "--effect area_lights=off,dispersion=off,focal_blur=off" rays.shadow_area rays.dispersed rays.focal_blur
none all "--effect media=off,fog=off,rainbow=off" media.cells fog.rays rainbow.rays
none all "--effect emission_photons=off,sky_light=off" rays.photon_emission rays.photon_sky
none clear "--integrator path --effect path_caustics=off" lights.met

run "$PMS" "$T/all.pms" $size -o "$T/a.exr" --stats=-
for counter in rays.shadow_area rays.shadow_media rays.dispersed rays.focal_blur media.cells fog.rays rainbow.rays \
    rays.photon_caustic rays.photon_global rays.photon_volume rays.photon_emission rays.photon_sky rays.sky \
    rays.cache gathers.caustic_photons gathers.volume_photons gather_rays.places lights.lit; do
    grep -q "\"$counter\": [1-9]" "$T/out"
    ok $? "$counter counts where nothing is off"
done
run "$PMS" "$T/clear.pms" $size --integrator path --light-radius 2 --aa 100 -o "$T/a.exr" --stats=-
grep -q '"lights.met": [1-9]' "$T/out"
ok $? "lights.met counts"

# Without caustics targets cast the shadows of a scene without photons{}.
same() {
    run "$PMS" "$T/$1.pms" $size $2 -o "$T/a.exr" && run "$PMS" "$T/$3.pms" $size $4 -o "$T/b.exr" &&
        run "$PMS" compare "$T/a.exr" "$T/b.exr" --max-rmse=0
    ok "$code" "$5"
}
same clear "--effect caustics=off" dark "" "caustics=off is a scene without photons{}"
same clear "--effect global_map=on" clear "--gi" "global_map=on is --gi"
same clear "--effect path_tracing=on" clear "--integrator=path" "path_tracing=on is --integrator=path"
same clear "--effect caustics=off,indirect=off" clear "--no-photons" "caustics and indirect off are --no-photons"
same clear "--effect caustics=off --effect caustics=on" clear "" "the last one holds"
same clear "--quality 5 --effect reflection=on,refraction=on,dispersion=on,caustics=on,indirect=on" clear "" \
    "an effect forced on is there at any quality"

# An effect that is off is one that the scene never had: the same pixels as without its words.
sed '/^global_settings/d' "$T/all.pms" >"$T/bare.pms"
without() {
    sed "s/$2//" "$T/bare.pms" >"$T/less.pms"
    same bare "--effect $1=off" less "" "$1=off is the scene without it"
}
without reflection 'reflection 0[.0-9]*'
without dispersion 'dispersion 1.05'
without absorption 'fade_distance 1 '
without area_lights 'area_light x, z, 3, 3'
without highlights 'specular 0.5'
without focal_blur 'aperture 0.1'
without sky_sphere '^sky_sphere.*'
without fog '^fog.*'
without rainbow '^rainbow.*'
without media '^media.*'
same bare "--effect lights=off" bare "--effect shadows=off,area_lights=off,highlights=off,lights=off" \
    "without lights there is nothing to cast shadows"

# Paths bring the light of sky and surfaces without asking a row of the plan: off all the same.
cat >"$T/sky.pms" <<'S'
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0,2,0> look_at <0,0,0.01> }
sky_sphere { pigment { rgb 1 } }
plane { y, 0 pigment { rgb 0.9 } finish { ambient 0 diffuse 0.8 } }
S
sed 's/^sky.*/box { <-9,4,-9>, <9,5,9> pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 1 } }/' \
    "$T/sky.pms" >"$T/lamp.pms"
for options in "--integrator=path --aa 4" "--gi=gather"; do
    for pair in sky:sky_light lamp:emission_photons; do
        scene=${pair%:*} effect=${pair#*:}
        run "$PMS" "$T/$scene.pms" $size $options -o "$T/a.exr" &&
            run "$PMS" "$T/$scene.pms" $size $options --effect $effect=off -o "$T/b.exr" &&
            run "$PMS" compare "$T/a.exr" "$T/b.exr"
        grep -qE '^means +0\.[3-9][0-9]* 0$' "$T/out"
        ok $? "$options: no light from there with $effect=off"
    done
done

shows "$T/plain.pms" "" caustic_map false && shows "$T/plain.pms" "--effect caustics=on" caustic_map true &&
    ! grep -q '"photons.caustic": 0' "$T/out"
ok $? "caustics=on without photons{} sends photons at what reflects or refracts"
run "$PMS" explain "$T/plain.pms" --effect=emission=on,fog=off
[ "$code" -eq 0 ] && grep -q "emission_photons.*asked for on the command line: a finish" "$T/out" &&
    grep -q "global_map.*asked for on the command line" "$T/out"
ok $? "explain says that the command line asked"
run "$PMS" explain "$T/plain.pms" --effect=emission=on,fog=off --json
[ "$code" -eq 0 ] && grep -q '"name": "emission_photons", "on": true, "forced": true' "$T/out" &&
    grep -q '"name": "fog", "on": false, "forced": true' "$T/out" &&
    grep -q '"name": "media", "on": false, "forced": false' "$T/out"
ok $? "and in JSON"

fails 2 "^pms: error: --effect fog=on is not possible here: no fog$" "no fog to force" \
    "$PMS" "$T/plain.pms" --effect fog=on -o "$T/a.exr"
fails 2 "global_map=on is not possible here: path tracing finds that light itself" "indirect light by paths" \
    "$PMS" explain "$T/plain.pms" --integrator=path --effect gi=on
fails 2 "there is no effect 'causics'; did you mean caustics\?$" "a slip of the fingers" \
    "$PMS" explain "$T/plain.pms" --effect causics=on
fails 2 "there is no effect 'xyzzy'; there are caustic_map, .*rainbow$" "nothing like any" \
    "$PMS" explain "$T/plain.pms" --effect xyzzy=on
fails 2 "wants fog=on or fog=off, got 'fog=maybe'$" "neither on nor off" \
    "$PMS" explain "$T/plain.pms" --effect fog=maybe,media=on
fails 2 "wants media=on or media=off, got 'media'$" "no value" "$PMS" explain "$T/plain.pms" --effect fog=off,media
P="$PMS $T/dark.pms $size --progressive -o $T/p.exr"
run $P --passes 1 --effect sky=off
fails 2 "effects sky_sphere=off, not reflection=off,sky_sphere=off" "a state of other effects" \
    $P --resume --passes 2 --effect sky=off,reflection=off
plan
