#!/bin/bash
# Claims in shards with GNU parallel: on this machine, or with --sshlogin on others that see the same folders.
#
#     examples/shards/parallel.sh SHARDS PARTS REPORT [options of `lostbits check`]
#
# A shard that fails is tried twice more; the log names each shard's time and exit status.
set -euo pipefail
shards=$1 parts=$2 report=$3
shift 3
mkdir -p "$parts"
seq "$shards" | parallel --will-cite --retries 3 --joblog "$parts/jobs.log" \
    "${LOSTBITS:-lostbits}" -q -j 1 check "$@" --shard "{}/$shards" --report "$parts"
"${LOSTBITS:-lostbits}" merge "$parts" -o "$report"
