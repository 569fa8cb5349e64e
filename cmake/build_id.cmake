cmake_minimum_required(VERSION 3.25)
# Writes the header OUT, which defines LOSTBITS_BUILD: the version and a hash of all HEADERS.
set(all "")
foreach(header IN LISTS HEADERS)
    file(SHA256 ${header} hash)
    string(APPEND all ${hash})
endforeach()
string(SHA256 hash "${all}")
string(SUBSTRING ${hash} 0 12 hash)
file(CONFIGURE OUTPUT ${OUT} CONTENT "// Identifies the headers that a library of forms was compiled with.
#pragma once
#define LOSTBITS_BUILD \"@VERSION@-@hash@\"
" @ONLY)
