#!/bin/sh
# Every figure of `make bench`, measured in one run on this machine: start-up, the photon map
# against nanoflann, the photon pass against raw Embree rays, threads, light at equal error against
# paths and povray, whole renders against povray.  Figures depend on what else the machine does:
# look at the ratios, run it alone.
set -u
cd "$(dirname "$0")/../.." || exit 1
PMS=${PMS:-build/release/pms}
BUILD=${BUILD:-build/release}
case $PMS in /*) ;; *) PMS=$PWD/$PMS ;; esac
T=$(mktemp -d) || exit 1
trap 'rm -rf "$T"' EXIT
size="-w 320 --height 240"

# least ROUNDS COMMAND...: the least wall and processor seconds of several runs
least() {
    perl -MTime::HiRes=time -e '
        my $rounds = shift; my ($wall, $cpu) = (1e9, 1e9);
        open(STDOUT_, ">&STDOUT"); open(STDOUT, ">/dev/null"); open(STDERR, ">/dev/null");
        for (1 .. $rounds) {
            my ($w, @c) = (time, times);
            system(@ARGV);
            my @d = times;
            my $t = time - $w; my $u = $d[2] + $d[3] - $c[2] - $c[3];
            $wall = $t if $t < $wall; $cpu = $u if $u < $cpu;
        }
        printf STDOUT_ "%.4f %.4f\n", $wall, $cpu;' "$@"
}

cat >"$T/ten.pms" <<'END'
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2, -5> look_at <0, 1, 0> }
light_source { <5, 9, -7>, 1 }
plane { y, 0 pigment { checker rgb 1 rgb .3 } }
#declare Ball = sphere { 0, 1 pigment { rgb <.9, .4, .2> } };
object { Ball translate y }
object { Ball scale .5 translate <2, .5, 0> }
box { -1, 1 scale .4 translate <-2, .4, 0> pigment { rgb <.2, .5, .9> } }
torus { .5, .1 translate <0, .1, -2> pigment { rgb .8 } }
END
least 20 "$PMS" check "$T/ten.pms" |
    awk '{ printf "start-up, check of ten lines: %.1f ms (reach 15)\n", $1 * 1000 }'

for bench in gather photon; do
    echo
    "$BUILD/tests/bench/${bench}_bench" || exit 1
done

echo
echo "threads, whole render, wall seconds"
for name in csg_showpiece caustic_glass; do
    one=$(least 3 "$PMS" scenes/$name.pms -w 640 --height 480 -j 1 -o "$T/x.exr" --progress none)
    two=$(least 3 "$PMS" scenes/$name.pms -w 640 --height 480 -j 2 -o "$T/x.exr" --progress none)
    echo "$name ${one% *} ${two% *}" |
        awk '{ printf "  %-22s one %7.3f   two %7.3f   %5.2f times (reach 1.85)\n", $1, $2, $3, $2 / $3 }'
done

echo
PMS=$PMS tests/bench/equal_error.pl

command -v povray >/dev/null 2>&1 || exit 0
echo
echo "whole renders against povray, 320x240, same file, antialiasing and photon count, seconds"
printf '  %-22s %5s %8s %8s %7s %8s %8s\n' scene AA "pms cpu" "povray" times "pms wall" povray
for scene in scenes/*.pms; do
    # pms { gi } is work povray does not do
    grep -q 'pms *{' "$scene" && continue
    for switch in -A +A0.3; do
        "$PMS" validate "$scene" $size $switch -J --json >"$T/json" 2>/dev/null || continue
        number() { sed -n "s/.*\"$1\": \([^,}]*\).*/\1/p" "$T/json"; }
        echo "$(basename "$scene" .pms) $switch $(number pms_cpu_seconds)" \
            "$(number povray_cpu_seconds) $(number pms_wall_seconds)" \
            "$(number povray_wall_seconds)"
    done
done | tee "$T/whole" |
    awk '{ printf "  %-22s %5s %8.3f %8.3f %7.2f %8.3f %8.3f\n", $1, $2, $3, $4, $4 / $3, $5, $6 }'
awk '{ r = $4 / $3; sum += log(r); if (NR == 1 || r < least) { least = r; name = $1 " " $2 } }
    END { printf "  geometric mean %.2f (reach 4), least %.2f (%s; reach 1)\n", exp(sum / NR), least, name }' \
    "$T/whole"
