// The functions that fill the table, each in its own translation unit: functions over batches, and functions for a
// single ray.
#pragma once

#include "intersect/catalogue.hpp"
#include "intersect/table/kernels.hpp"

namespace lostbits::intersect::table {

void fill_batches(std::span<Intersector> forms);
void fill_by_ray(std::span<Intersector> forms);

}  // namespace lostbits::intersect::table
