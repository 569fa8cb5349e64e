#!/bin/bash
# A sharded sweep over every float of a range, three rays at a sphere, held to whole-number arithmetic: every count of
# hits of the merged result, and the decision about each of some random rays.
#
#     tests/engines/scale.sh PROGRAM EXAMPLES [SHARDS RAYS FROM TO]
#
# Without FROM and TO the range is every float there is, 12,884,901,888 rays.
set -u
LOSTBITS=$(realpath "$1") sweep=$(realpath "$2")/shards/ten-billion.toml shards=${3-32} rays=${4-10000000}
exact="python3 $(realpath "$(dirname "$0")")/exact_decisions.py"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
fail() { echo "FAILED: $*"; exit 1; }

if [[ -n ${5-} ]]; then
    sed "s/^all = true/from = \"$5\"\nto = \"$6\"/" "$sweep" >ten-billion.toml
else
    cp "$sweep" .
fi
for ((k = 1; k <= shards; ++k)); do
    "$LOSTBITS" -q sweep ten-billion.toml -i sphere.unified -f f32 --shard "$k/$shards" -o parts || fail "shard $k"
done
"$LOSTBITS" -q merge parts -o merged || fail "merge"
$exact counts merged/ten-billion/binades.csv || fail "counts"

# The random rays are answered by exact_decisions.py: what judge calls wrong is where its truth and those differ.
$exact rays "$rays" 1 random.f32 || fail "rays"
"$LOSTBITS" -q judge random.f32 --columns ox:f32,oy,oz,dx,dy,dz,hit:u8 --sphere 0.5,-0.25,-0.25,0x1.3988e2p-1 \
    -o judged || fail "judge"
python3 - judged/random/summary.csv "$rays" <<'PYTHON' || fail "decisions"
import csv
import sys

row = next(csv.DictReader(open(sys.argv[1])))
wrong = sum(int(row[name]) for name in ("false_hit", "false_miss", "not_a_number"))
print(f"{row['rays']} random rays, {row['agree_hit']} hits, {wrong} decided differently")
sys.exit(wrong != 0 or int(row["rays"]) != int(sys.argv[2]) or int(row["agree_hit"]) == 0)
PYTHON
