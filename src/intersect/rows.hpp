// The three translation units that fill the table, one per family of arithmetic: they compile side by side.
#pragma once

#include "intersect/kernels.hpp"

namespace lostbits {

/// Every form of every shape, in the order of the table.
inline constexpr std::size_t form_count = SphereForms::size + BoxForms::size;
template <class Visitor>
void for_each_form(Visitor&& visit) {
    SphereForms::for_each(visit);
    BoxForms::for_each(visit);
}

void fill_native(std::span<Intersector> rows);
void fill_rounded(std::span<Intersector> rows);
void fill_enclosed(std::span<Intersector> rows);

}  // namespace lostbits
