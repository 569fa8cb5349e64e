#!/bin/bash
# The examples of shards with make and with GNU parallel, run as they stand: each result is that of one run.
#
#     tests/engines/shards.sh PROGRAM EXAMPLES
set -u
LOSTBITS=$(realpath "$1") examples=$(realpath "$2")
export LOSTBITS
command -v parallel >/dev/null || { echo "skipped: GNU parallel is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
fail() { echo "FAILED: $*"; exit 1; }

# A picture of five bands in three shards; one of them is lost, and made again alone.
options="-i sphere.schoolbook -i sphere.unified -f f32 --size 64x2300"
made=(make -s -j 2 -f "$examples/shards/Makefile" SCENE=near-benign "OPTIONS=$options" SHARDS=3 OUT=made)
"${made[@]}" || fail "make"
before=$(stat -c %Y.%i made.parts/shard-1-of-3/shard.state)
rm -r made made.parts/shard-2-of-3
"${made[@]}" || fail "make again"
[[ $(stat -c %Y.%i made.parts/shard-1-of-3/shard.state) == "$before" ]] || fail "a shard that was there was run again"
rm made/.joined
# shellcheck disable=SC2086
"$LOSTBITS" -q map near-benign $options -o whole || fail "the whole map"
diff -r whole made || fail "the map of make is another one"
echo "make: the map of 3 shards is that of one run"

"$examples/shards/parallel.sh" 4 parts report --filter 'float.*' >/dev/null || fail "parallel"
[[ $(wc -l <parts/jobs.log) == 5 ]] || fail "parallel did not run four jobs"
"$LOSTBITS" -q check --filter 'float.*' --report one >/dev/null || fail "the whole check"
diff -r one report || fail "the report of parallel is another one"
echo "GNU parallel: the report of 4 shards is that of one run"
