// The same code, compiled as by somebody who does not know about contraction.
#include "only_march.cpp"
