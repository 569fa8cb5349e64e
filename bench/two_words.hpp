// `sphere.filtered` wholly in double-double, to hold the form against: what proving every ray that way would cost.
#pragma once

#include "by_hand.hpp"

namespace bench {

by_hand::OneSolid<double> two_words_w128();
by_hand::OneSolid<double> two_words_w256();
by_hand::OneSolid<double> two_words_w512();

}  // namespace bench
