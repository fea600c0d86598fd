#!/bin/sh
# A progressive render of caustics, indirect light and media together, killed by kill -9 at random
# moments; each is resumed to its end and comes to the bytes of the uninterrupted render.  KILLS is
# the number of rounds; `make check-kill` does 20.
. "$(dirname "$0")/tap.sh"
cat >"$T/s.pms" <<'S'
#version 3.7;
global_settings {
  assumed_gamma 1
  photons { count 6000 media 10 }
  pms { gi on global_photons 6000 }
}
camera { location <0, 1.5, -3.5> look_at <0, 0.9, 0> angle 50 }
light_source { <-1, 2.8, 0.5>, 2 spotlight point_at <0, 0.6, 0> radius 25 falloff 40
  photons { reflection on refraction on } }
media { scattering { 1, 0.05 extinction 1 } }
box { <-2, 0, -4>, <2, 3, 2> hollow pigment { checker rgb <.8, .5, .4> rgb <.5, .7, .8> }
  finish { ambient 0 diffuse 0.8 } }
sphere { <0, 0.7, 0>, 0.5 pigment { rgbt 1 } finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel } conserve_energy }
  interior { ior 1.5 } photons { target refraction on reflection on collect off } }
S
passes=8
P="$PMS $T/s.pms -w 32 --height=24 --progressive --passes=$passes --layers=caustic,indirect --progress=none"

# How long a whole render takes sets the range of the moments.
start=$(date +%s%N)
run $P --threads=2 -o "$T/all.exr"
[ "$code" -eq 0 ] && [ -s "$T/all.exr.pmsstate" ]
ok $? "$passes passes without interruption"
took=$((($(date +%s%N) - start) / 1000000))

round=0
while [ $round -lt "${KILLS:-3}" ]; do
    round=$((round + 1))
    rm -f "$T/killed".*
    $P --threads=$((round % 3 + 1)) -o "$T/killed.exr" 2>/dev/null &
    moment=$(od -An -N4 -tu4 /dev/urandom | awk -v took="$took" '{ print int($1 % (took + 1)) }')
    sleep "$(awk -v ms="$moment" 'BEGIN { printf "%.3f", ms / 1000 }')"
    kill -9 $! 2>/dev/null
    wait $! 2>/dev/null
    ended=$?
    left="no state"
    [ -e "$T/killed.exr.pmsstate" ] && left="a state"
    [ $ended -eq 137 ] || left="the end"
    run $P --resume --threads=$(((round + 1) % 3 + 1)) -o "$T/killed.exr"
    [ "$code" -eq 0 ] && cmp "$T/killed.exr.pmsstate" "$T/all.exr.pmsstate" >"$T/err" 2>&1 &&
        "$PMS" compare "$T/killed.exr" "$T/all.exr" --max-rmse=0 >"$T/out" 2>"$T/err"
    ok $? "killed after $moment of $took ms (it had reached $left): resumed to the same bytes"
done
plan
