#!/bin/bash
# The script of the workflows beside this file. It builds the library under test, tests what the library promises,
# checks the claims, and shows how the measured values moved since the baseline in the repository.
#
#     measure.sh LOSTBITS HEADERS     the program, and the folder of lostbits_plugin.hpp
#
# It writes mine.so, junit.xml, moves.md and baseline.json to the current folder. To make the present values the
# baseline, commit that baseline.json beside claims.toml.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
lostbits=${1:-lostbits} headers=${2:-/usr/include}

"${CXX:-c++}" -O2 -std=c++17 -shared -fPIC -I"$headers" "$here/mine.cpp" -o mine.so
"$lostbits" plugin check mine.so

against=()
[[ -e $here/baseline.json ]] && against=(--against "$here/baseline.json" --moves moves.md)
"$lostbits" check "$here/claims.toml" --profile libraries --plugin ./mine.so --strict \
    --save baseline.json "${against[@]}" --junit junit.xml ${GITHUB_ACTIONS:+--annotations github} && code=0 || code=$?

# Shows the table of moves in the summary of the checks of a pull request.
[[ -n ${GITHUB_STEP_SUMMARY-} && -e moves.md ]] && cat moves.md >>"$GITHUB_STEP_SUMMARY"
exit "$code"
