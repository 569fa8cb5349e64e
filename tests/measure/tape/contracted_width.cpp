// Every form over plain numbers, compiled so that a product may be rounded together with the sum to which it is added.
#include "measure/tape/contracted_width.hpp"

#include "intersect/catalogue.hpp"
#include "intersect/form_shape.hpp"

namespace lostbits::test::test_contraction {

namespace {

/// Flattened, so that no function of a header is left under its ordinary name, compiled with these flags.
template <class Form, class F>
[[gnu::flatten]] void ask(const F* in, F* t, F* near, F* far, unsigned char* hit) {
    const Ray<F> ray{{in[0], in[1], in[2]}, {in[3], in[4], in[5]}};
    const F end = __builtin_inf();
    const Hit<F> answer = intersect::intersect_numbers<Form>(
        ray, [in](std::size_t k) { return in[6 + k]; }, end);
    *t = answer.t, *near = answer.near, *far = answer.far;
    *hit = answer.hit;
}

}  // namespace

void fill_contracted(PlainFormKernels* rows) {
    intersect::AllForms::for_each([&rows]<class Form>() {
        if constexpr (!intersect::marches<Form> && !Form::info.name.ends_with(".filtered")) {
            rows->f32 = ask<Form, float>;
            if constexpr (Form::info.formats == intersect::Formats::all) rows->f64 = ask<Form, double>;
        }
        ++rows;
    });
}

}  // namespace lostbits::test::test_contraction
