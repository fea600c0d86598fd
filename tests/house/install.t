#!/bin/sh
# What `make install` puts somewhere works from there, and `make uninstall` takes all of it away, and
# nothing else.
cd "$(dirname "$0")/../.." || exit 1
echo "1..4"
T=$(mktemp -d) || exit 1
trap 'rm -rf "$T"' EXIT
check() { [ "$1" -eq 0 ] && echo "ok $2" || { echo "not ok $2"; sed 's/^/# /' "$T/log"; }; }
goal() { env -u MAKEFLAGS make "$1" MODE="${MODE:-release}" DESTDIR="$T/root" PREFIX=/opt/pms >"$T/log" 2>&1; }

mkdir -p "$T/root/opt/pms/share/pms"
goal install
check $? "1 - install"
echo '#include "pms_glass.inc" #version 3.7; sphere { 0, 1 interior { ior pms_ior_bk7 } }' >"$T/s.pms"
(cd "$T" && root/opt/pms/bin/pms check s.pms >"$T/log" 2>&1) &&
    [ -s "$T/root/opt/pms/share/man/man1/pms.1" ] && [ -s "$T/root/opt/pms/share/man/man5/pms.5" ]
check $? "2 - the installed program finds its materials"
echo mine >"$T/root/opt/pms/bin/other"
goal uninstall && goal uninstall
check $? "3 - uninstall, twice"
find "$T/root" -type f >"$T/log"
[ "$(cat "$T/log")" = "$T/root/opt/pms/bin/other" ] && [ ! -e "$T/root/opt/pms/share/pms" ]
check $? "4 - nothing is left, and nothing else is gone"
