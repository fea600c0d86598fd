#!/bin/sh
# The pages and the program say the same: every option and command is in the man page, and every word
# the program prints as the name of a number; the man pages are well formed, and what the program
# lists is what option.def lists.
cd "$(dirname "$0")/../.." || exit 1
echo "1..5"

missing=
for name in $(sed -n 's/^X(OPT_[A-Z_]*, [^,]*, "\([a-z-]*\)".*/\1/p' src/cli/option.def); do
    grep -qE "Fl (h , Fl )?-$name( |$)" man/pms.1 || missing="$missing --$name"
done
[ -z "$missing" ] && echo "ok 1 - every option is in pms(1)" ||
    { echo "not ok 1 - every option is in pms(1)"; echo "# missing:$missing"; }

missing=
for name in $(sed -n 's/^X("\([a-z]*\)".*/\1/p' src/cli/command.def); do
    grep -q "^\.It Cm $name$" man/pms.1 || missing="$missing $name"
done
[ -z "$missing" ] && echo "ok 2 - every command is in pms(1)" ||
    { echo "not ok 2 - every command is in pms(1)"; echo "# missing:$missing"; }

if command -v mandoc >/dev/null; then
    lint=$(mandoc -T lint -W warning man/*.[15] 2>&1)
    [ -z "$lint" ] && echo "ok 3 - man pages are well formed" ||
        { echo "not ok 3 - man pages are well formed"; echo "$lint" | sed 's/^/# /'; }
else
    echo "ok 3 # skip mandoc is not installed"
fi

# Neither this checkout's own place nor anybody's home may be written anywhere.
bad=$(grep -rlF -e "$PWD" -e "${HOME:-/home}/" -e /home/ README.md src grammar scenes stdlib man tests/image .ci)
[ -z "$bad" ] && echo "ok 4 - no path of one machine" ||
    { echo "not ok 4 - no path of one machine"; echo "$bad" | sed 's/^/# /'; }

# The keys of all that is printed as JSON, and the first words of the lines of compare and validate.
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
PMS=${PMS:-build/release/pms}
cat >"$tmp/s.pms" <<'S'
#version 3.7;
global_settings { assumed_gamma 1 photons { count 500 media 1 } pms { gi on global_photons 500 } }
camera { location <0, 2, -5> look_at 0 }
light_source { <2, 4, -3>, 1 }
media { scattering { 1, 0.01 } }
plane { y, -1 hollow pigment { rgb 0.8 } }
sphere { 0, 1 hollow pigment { rgbf 1 } interior { ior 1.5 } photons { target refraction on } }
S
sed 's/ pms { .* } }$/ }/; s/count 500 media 1/count 500/' "$tmp/s.pms" >"$tmp/plain.pov"
size="-w 16 --height=12 --progressive --passes=1 --progress=none"
{
    $PMS "$tmp/s.pms" $size --stats=- -o "$tmp/a.png"
    $PMS explain "$tmp/s.pms" --progressive --passes=2 --json
    $PMS compare "$tmp/a.png" "$tmp/a.png" --json
    command -v povray >/dev/null && $PMS validate "$tmp/plain.pov" -w 16 --height=12 --json
} 2>"$tmp/err" | grep -oE '"[a-z_.]+":' | tr -d '":' >"$tmp/words"
$PMS compare "$tmp/a.png" "$tmp/a.png" | sed 's/ .*//' >>"$tmp/words"
grep -E '^\.(It|Ic|Pq) ' man/pms.1 | tr ' ' '\n' | sort -u >"$tmp/known"
missing=$(sort -u "$tmp/words" | comm -23 - "$tmp/known" | tr '\n' ' ')
[ "$(sort -u "$tmp/words" | wc -l)" -gt 100 ] && [ -z "$missing" ] &&
    echo "ok 5 - every word for a number is in pms(1)" ||
    { echo "not ok 5 - every word for a number is in pms(1)"; echo "# missing: $missing"
      sed 's/^/# /' "$tmp/err"; }
