// A pair of doubles that a file of its own rounds to floats: nobody who calls it knows what it is made of.
#pragma once

namespace lostbits::test {

struct PairOfDoubles {
    double first, second;
};

PairOfDoubles rounded_pair(double first, double second);

}  // namespace lostbits::test
