// `sphere.filtered` entirely in double-double, to compare the form with: the cost of proving every ray in that way.
#pragma once

#include "by_hand.hpp"

namespace bench {

by_hand::OnePrimitive<double> two_words_w128();
by_hand::OnePrimitive<double> two_words_w256();
by_hand::OnePrimitive<double> two_words_w512();

}  // namespace bench
