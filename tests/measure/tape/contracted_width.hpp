// What test_contraction.cpp and the object that is compiled with -ffp-contract=fast say to each other.
#pragma once

#include "intersect/simd/packed_raw.hpp"

namespace lostbits::test::test_contraction {

/// A row for each form, in the order of the catalogue.
void fill_contracted(intersect::simd::RawRow* rows);

}  // namespace lostbits::test::test_contraction
