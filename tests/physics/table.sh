#!/bin/sh
# Print what the tests of light measure, beside what is expected and the standard error.  Arguments:
# the tests.  The exit code is 1 when one of them fails.
failed=0
printf '%-58s %12s %12s %11s\n' 'what' 'measured' 'expected' 'std. error'
for test; do
    name=$(basename "$test")
    output=$(PMS_LONG=1 CMOCKA_MESSAGE_OUTPUT=TAP "$test" 2>&1)
    code=$?
    printf '%s\n' "$name"
    printf '%s\n' "$output" | sed -n 's/^#| /  /p'
    [ $code -eq 0 ] && continue
    failed=1
    printf '%s\n' "$output" | grep '^not ok' | sed "s/^/  FAILED: /"
done
[ $failed -eq 0 ] && echo 'all as expected' || echo 'NOT all as expected'
exit $failed
