// The translation units that fill the table, one per family of arithmetic: they compile side by side.
#pragma once

#include "intersect/catalogue.hpp"
#include "intersect/table/kernels.hpp"

namespace lostbits::intersect::table {

void fill_native(std::span<Intersector> rows);
void fill_rounded(std::span<Intersector> rows);
void fill_enclosed(std::span<Intersector> rows);
void fill_logs(std::span<Intersector> rows);
void fill_recorded(std::span<Intersector> rows);
void fill_counted(std::span<Intersector> rows);
void fill_bounded(std::span<Intersector> rows);

}  // namespace lostbits::intersect::table
