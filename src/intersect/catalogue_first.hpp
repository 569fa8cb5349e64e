// The forms of the first part of `shapes/list.hpp`.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/primitive.hpp"
// clang-format off
#define LOSTBITS_SHAPE_FILE(folder) LOSTBITS_PATH(folder/forms/forms.hpp)
#define LOSTBITS_SHAPE_PART 1
// clang-format on
#include "shapes/list.hpp"

namespace lostbits::intersect {

#define LOSTBITS_LINE(folder, S) folder::S##Forms,
struct FirstForms : JoinedLists<LOSTBITS_FIRST_SHAPES(LOSTBITS_LINE) FormList<>> {};
#undef LOSTBITS_LINE

}  // namespace lostbits::intersect
