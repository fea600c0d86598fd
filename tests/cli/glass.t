#!/bin/sh
# The dispersion formulas of stdlib/pms_glass.inc give the indices and Abbe numbers it states, and
# pms and POV-Ray both take them.
. "$(dirname "$0")/tap.sh"

# scene NAME KIND: one that fails unless the formula of NAME says what the table says of it
scene() {
    cat <<END
#version 3.7;
#include "pms_glass.inc"
global_settings { assumed_gamma 1 }
camera { location -5*z look_at 0 }
#local D = pms_$2_at(pms_$2_$1, 0.58756);
#local F = pms_$2_at(pms_$2_$1, 0.48613);
#local C = pms_$2_at(pms_$2_$1, 0.65627);
#if (abs(D - pms_ior_$1) > 6e-6) #error concat("index of $1 is ", str(D, 0, 6)) #end
#local Abbe = (D - 1) / (F - C);
#if (abs(Abbe - pms_abbe_$1) > 0.06) #error concat("Abbe number of $1 is ", str(Abbe, 0, 3)) #end
sphere { 0, 1 texture { pms_clear } interior { pms_$2(pms_$2_$1) dispersion_samples 3 } }
END
}

for glass in bk7:sellmeier f2:sellmeier sf10:sellmeier sf11:sellmeier silica:sellmeier \
    sapphire:sellmeier diamond:sellmeier acrylic:sellmeier polycarbonate:sellmeier \
    water:sellmeier ethanol:cauchy; do
    name=${glass%:*}
    scene "$name" "${glass#*:}" >"$T/$name.pov"
    run "$PMS" check "$T/$name.pov" -L "$ROOT/stdlib"
    ok "$code" "pms: $name"
    if command -v povray >/dev/null; then
        run povray "+I$T/$name.pov" "+O$T/x.png" "+L$ROOT/stdlib" +W4 +H3 -D
        ok "$code" "POV-Ray: $name"
    else
        skip "no povray"
    fi
done
run "$PMS" explain "$T/bk7.pov" -L "$ROOT/stdlib"
grep -q "^dispersion  *an interior with sellmeier in pms{}, seen in 3 bands" "$T/out"
ok $? "explain says who asked for dispersion"
plan
