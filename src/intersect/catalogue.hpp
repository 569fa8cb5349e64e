// All forms: those of each shape, which the folder of the shape lists, and those that march. Every table of forms is
// generated from these lists.
#pragma once

#include "intersect/catalogue_first.hpp"
#include "intersect/catalogue_second.hpp"

namespace lostbits::intersect {

/// Every form of every shape, in the order of the tables.
using AllForms = JoinedLists<FirstForms, SecondForms>;
inline constexpr std::size_t form_count = AllForms::size;

}  // namespace lostbits::intersect
