// Plain loops over boxes. packed_batch.hpp says which headers such a file may include, and why everything is inlined.
#include "intersect/catalogue_first.hpp"
#include "intersect/simd/plain_many.hpp"

namespace lostbits::intersect::simd {
namespace {

/// Beyond __restrict, the compiler gets no help to vectorise. __restrict says that no other pointer writes to the
/// memory that these pointers address.
template <class Form>
[[gnu::flatten]] void intersect_columns(const float* ray, const float* const* columns, float* __restrict t,
                                        std::size_t n) {
    const Ray<float> r{{ray[0], ray[1], ray[2]}, {ray[3], ray[4], ray[5]}};
    const float* __restrict lo_x = columns[0], * __restrict lo_y = columns[1], * __restrict lo_z = columns[2];
    const float* __restrict hi_x = columns[3], * __restrict hi_y = columns[4], * __restrict hi_z = columns[5];
    for (std::size_t i = 0; i < n; ++i) {
        const Hit<float> hit =
            Form::intersect(r, Box<float>{{lo_x[i], lo_y[i], lo_z[i]}, {hi_x[i], hi_y[i], hi_z[i]}}, t[i]);
        t[i] = hit.hit ? hit.t : t[i];
    }
}

template <class Form>
[[gnu::flatten]] void intersect_structs(const float* ray, const PlainBox* __restrict boxes, float* __restrict t,
                                        std::size_t n) {
    const Ray<float> r{{ray[0], ray[1], ray[2]}, {ray[3], ray[4], ray[5]}};
    for (std::size_t i = 0; i < n; ++i) {
        const float* const b = boxes[i].numbers;
        const Hit<float> hit = Form::intersect(r, Box<float>{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}}, t[i]);
        t[i] = hit.hit ? hit.t : t[i];
    }
}

/// True if the form calls wider arithmetic. Such a call is not inlined, and the called function would be compiled under
/// its ordinary name in this unit. The linker could keep that copy for every caller, also on processors without these
/// instructions. gcc makes local clones of the function; clang 14 does not.
template <class Form>
constexpr bool calls_wider_arithmetic = requires(Ray<float> ray, Box<float> box, float limit, NoWatch watch) {
    Form::intersect(ray, box, limit, watch);
};

}  // namespace

void fill_plain_w256(PlainFormKernels* row) {
    box::BoxForms::for_each([&row]<class Form>() {
        if constexpr (!calls_wider_arithmetic<Form>) {
            row->columns = intersect_columns<Form>;
            row->structs = intersect_structs<Form>;
        }
        ++row;
    });
}

}  // namespace lostbits::intersect::simd
