#!/bin/sh
# Install the Debian packages given as arguments that are missing; on another system, name them.
missing=
if command -v dpkg-query >/dev/null 2>&1; then
    for package in "$@"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
            missing="$missing $package"
    done
    [ -z "$missing" ] && exit 0
    sudo=
    [ "$(id -u)" -eq 0 ] || sudo=sudo
    echo "installing:$missing" >&2
    export DEBIAN_FRONTEND=noninteractive
    $sudo apt-get update -q >&2 || exit 3
    # shellcheck disable=SC2086
    exec $sudo apt-get install -q -y --no-install-recommends $missing >&2
fi
command -v pkg-config >/dev/null 2>&1 && command -v prove >/dev/null 2>&1 &&
    pkg-config --exists OpenEXR OpenColorIO libpng libtiff-4 freetype2 cmocka && exit 0
cat >&2 <<EOF
pms needs: a C17 and a C++17 compiler, GNU make, pkg-config, prove (perl), and the libraries
Embree 3, OpenEXR 3.1, OpenColorIO 2.1, libpng, libjpeg-turbo, libtiff 4.5,
giflib, FreeType, cmocka; the comparisons also use
nanoflann and povray 3.7.  The names of the Debian packages are:
    $*
EOF
exit 3
