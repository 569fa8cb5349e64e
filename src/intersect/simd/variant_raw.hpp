// What variants.cpp and the translation units of the variants say to each other.
#pragma once

#include "intersect/simd/packed_raw.hpp"

namespace lostbits::intersect::simd {

/// One function a variant, each in an object of its own: fills a row for each form, in the order of the tables.
void fill_variant_contract(RawRow* rows);
void fill_variant_fastmath(RawRow* rows);

}  // namespace lostbits::intersect::simd
