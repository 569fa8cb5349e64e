#!/bin/bash
# The shell part of the workflows in examples/ci, run as they call it: without a baseline, with one, and with a library
# that changed under the claims.
#
#     tests/engines/ci.sh PROGRAM EXAMPLES HEADERS
set -u
program=$(realpath "$1") examples=$(realpath "$2") headers=$(realpath "$3")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r "$examples/ci" "$work/ci"
cd "$work" || exit 1
fail() { echo "FAILED: $*"; cat log 2>/dev/null; exit 1; }

ci/measure.sh "$program" "$headers" >log 2>&1 || fail "the first run"
[[ -s junit.xml && -s baseline.csv && ! -e changes.txt ]] || fail "files of the first run"
grep -q '2 verdicts confirmed, 0 failed' log || fail "the claims"

cp baseline.csv ci/
GITHUB_STEP_SUMMARY=$work/summary.md ci/measure.sh "$program" "$headers" >log 2>&1 || fail "the run with a baseline"
grep -qx same changes.txt || fail "what did not change"
grep -qx '    same' summary.md || fail "the summary of the workflow"

# Somebody "simplifies": the root that cancels is taken by way of doubles.
sed -i 's|const float disc = b \* b - 4 \* a \* c;|const float disc = (float)((double)b * b - 4.0 * a * c);|' ci/mine.cpp
GITHUB_ACTIONS=true ci/measure.sh "$program" "$headers" >log 2>&1
code=$?
grep -q 'mylib\.[a-z]*.*: measured: ' changes.txt || fail "no value changed, exit $code"
echo "the workflow's script: claims confirmed, nothing changed, then $(grep -c ': measured: ' changes.txt) values (exit $code)"
