// The same as someone may compile it who does not know of contraction.
#include "only_march.cpp"
