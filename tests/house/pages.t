#!/bin/sh
# The pages and the program say the same: every option and command is in the man page, the
# man pages are well formed, and what the program lists is what option.def lists.
cd "$(dirname "$0")/../.." || exit 1
echo "1..4"

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
