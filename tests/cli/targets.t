#!/bin/sh
# What lamps that no target sees do to a picture with photons.
. "$(dirname "$0")/tap.sh"

# glass PHOTONS LAMPS: a glass ball over a floor, both in a clear box full of smoke
glass() {
    cat <<END
#version 3.7;
global_settings { assumed_gamma 1 photons { count 5000 media 100 } }
camera { location <0,1,-3.5> look_at 0 angle 90 }
$2
sphere { <0,1,0>, 1 pigment { rgbt 1 } interior { ior 1.5 } photons { $1 } finish { ambient 0 diffuse 0 } }
box { <-4,-4,-4>, <4,4,4> hollow pigment { rgbt 1 } interior { media { scattering { 1, 0.1 } } } photons { refraction off } }
plane { y, -3.9 pigment { rgb 0.5 } finish { ambient 0 } }
END
}

# picture NAME PHOTONS LAMPS
picture() {
    glass "$2" "$3" >"$T/$1.pms"
    run "$PMS" "$T/$1.pms" -w 80 --height 60 -o "$T/$1.exr"
}

# alike A B LIMIT: their root mean square error is below
alike() {
    run "$PMS" compare "$T/$1.exr" "$T/$2.exr" --max-rmse="$3"
}

outside='light_source { <0,5,0> 1 photons { refraction on } }'
target='target refraction on reflection off'
picture plain 'refraction off' "$outside"
picture blind "$target" "$outside"
grep -q "no caustic map: no light reaches a target" "$T/err"
ok $? "photons do not pass a box that is no target"
alike blind plain 1e-6
ok "$code" "a target that no light reaches casts a filtered shadow"
picture other "$target" "$outside light_source { <0,3.9,0> 1e-9 }"
grep -q "no light reaches" "$T/err"
said=$?
alike other plain 0.02
[ $said -ne 0 ] && [ "$code" -eq 1 ]
ok $? "a full one, when another lamp reaches it"

inside='light_source { <0,3.5,0> 1 photons { refraction on } }'
away='spotlight point_at <0,40,0> radius 5 falloff 6'
picture one "$target" "$inside"
for photons in off on; do
    picture more "$target" "$inside light_source { <0,20,0> 1e6 $away
        photons { refraction $photons reflection $photons } }"
    alike more one 1e-4
    ok "$code" "a bright lamp turned away, its photons $photons, changes nothing"
done

plan
