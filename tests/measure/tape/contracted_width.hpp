// Interface between test_contraction.cpp and the object compiled with -ffp-contract=fast: plain pointers.
#pragma once

namespace lostbits::test::test_contraction {

/// A form on one ray and the numbers of one primitive behind it.
template <class F>
using EvaluatePlain = void (*)(const F* in, F* t, F* near, F* far, unsigned char* hit);

struct PlainFormKernels {
    EvaluatePlain<float> f32 = nullptr;
    EvaluatePlain<double> f64 = nullptr;
};

/// A row for each form, in the order of the catalogue; null for those that march or filter.
void fill_contracted(PlainFormKernels* rows);

}  // namespace lostbits::test::test_contraction
