# What the command line tests share: sourced by each.  Needs $PMS; gives a scratch folder $T
# that is removed at the end, and ok/plan.
: "${PMS:=build/release/pms}"
cd "$(dirname "$0")/../.." || exit 1
case $PMS in /*) ;; *) PMS=$PWD/$PMS ;; esac
ROOT=$PWD
T=$(mktemp -d) || exit 1
trap 'rm -rf "$T"' EXIT
n=0

# ok STATUS NAME: report a test that passed if STATUS is 0.
ok() {
    n=$((n + 1))
    if [ "$1" -eq 0 ]; then echo "ok $n - $2"; else
        echo "not ok $n - $2"
        [ -s "$T/err" ] && sed 's/^/# /' "$T/err" | head -5
    fi
}

skip() {
    n=$((n + 1))
    echo "ok $n # skip $1"
}

# run COMMAND...: output to $T/out, messages to $T/err, exit code to $code.
run() {
    "$@" >"$T/out" 2>"$T/err" </dev/null
    code=$?
}

# fails CODE PATTERN NAME COMMAND...: the command ends with CODE and says PATTERN, and does not
# crash.
fails() {
    want=$1 pattern=$2 name=$3
    shift 3
    run "$@"
    [ "$code" -eq "$want" ] && grep -qE -- "$pattern" "$T/err"
    ok $? "$name (exit $code)"
}

plan() { echo "1..$n"; }
