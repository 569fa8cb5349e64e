#!/bin/bash
# The script of the workflows beside this file. It builds the library under test, tests what the library promises,
# checks the claims, and shows which measured values differ from the baseline in the repository.
#
#     measure.sh LOSTBITS HEADERS     the program, and the folder of lostbits_plugin.hpp
#
# It writes mine.so, junit.xml, baseline.csv and changes.txt to the current folder. To make the present values the
# baseline, commit that baseline.csv beside claims.toml.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
lostbits=${1:-lostbits} headers=${2:-/usr/include}

"${CXX:-c++}" -O2 -std=c++17 -shared -fPIC -I"$headers" "$here/mine.cpp" -o mine.so
"$lostbits" plugin check mine.so

"$lostbits" check "$here/claims.toml" --profile libraries --plugin ./mine.so --strict \
    --export-csv baseline.csv --junit junit.xml ${GITHUB_ACTIONS:+--annotations github} && code=0 || code=$?

# Shows the changes in the summary of the checks of a pull request. They alone do not fail it.
if [[ -e $here/baseline.csv ]]; then
    "$lostbits" diff "$here/baseline.csv" baseline.csv | tee changes.txt || true
    [[ -z ${GITHUB_STEP_SUMMARY-} ]] || sed 's/^/    /' changes.txt >>"$GITHUB_STEP_SUMMARY"
fi
exit "$code"
