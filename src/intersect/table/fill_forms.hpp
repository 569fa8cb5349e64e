// The functions that fill the table for a part of the catalogue. They are compiled for `FirstForms` and `SecondForms`,
// and a source that only calls them does not depend on the forms.
#pragma once

#include <span>
#include <vector>

#include "intersect/form_list.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// Appends the forms of a part, with their functions over batches.
template <class Forms>
void append_forms(std::vector<Intersector>& forms);

/// Adds the functions for a single ray. `forms` begins with the forms of a part; returns those after them.
template <class Forms>
std::span<Intersector> fill_by_ray(std::span<Intersector> forms);

}  // namespace lostbits::intersect::table
