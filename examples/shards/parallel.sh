#!/bin/bash
# Checks claims in shards with GNU parallel, on this machine or with --sshlogin on others that see the same folders.
#
#     examples/shards/parallel.sh SHARDS PARTS REPORT [options of `lostbits check`]
#
# A shard that fails is tried twice more. The log has the time and the exit status of each shard.
set -euo pipefail
shards=$1 parts=$2 report=$3
shift 3
mkdir -p "$parts"
seq "$shards" | parallel --will-cite --retries 3 --joblog "$parts/jobs.log" \
    "${LOSTBITS:-lostbits}" -q -j 1 check "$@" --shard "{}/$shards" --report "$parts"
"${LOSTBITS:-lostbits}" merge "$parts" -o "$report"
