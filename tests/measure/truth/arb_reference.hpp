// The same question answered in ball arithmetic of rising precision (Arb), by the textbook's formula: the precision
// makes up for its cancellations.
#pragma once

#if ARB_IN_FLINT
#include <flint/arb.h>
#else
#include <arb.h>
#endif

#include "shapes/box/box.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits::testing {

class ArbReference {
public:
    ArbReference();
    ~ArbReference();
    ArbReference(const ArbReference&) = delete;
    ArbReference& operator=(const ArbReference&) = delete;

    enum class Decision { miss, hit, undecided };
    struct Answer {
        Decision decision = Decision::undecided;
        /// t* rounded to nearest double; false in `rounded` where the highest precision left two candidates, which
        /// only an exact tie with an inexact division can do.
        double t = 0;
        bool rounded = false;
        long bits = 0;
    };
    Answer find(const Ray<double>& ray, const Sphere<double>& sphere);

private:
    Decision decide(long bits);
    void root(long bits);
    /// Sets `to` to x·y (+ `to`): dot products term by term.
    void dot(arb_t to, const arb_t* x, const arb_t* y, long bits);

    arb_t f_[3], d_[3], r_, o_, a_, h_, c_, disc_, t_;
    bool inside_ = false, on_surface_ = false;
};

}  // namespace lostbits::testing
