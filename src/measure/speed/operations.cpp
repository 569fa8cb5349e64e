#include "measure/speed/operations.hpp"

#include "intersect/table/rows.hpp"

namespace lostbits::measure::speed {

OperationCounts operations_of(const intersect::Info& form, const Ray<float>& ray, const Solid<float>& solid,
                              float tmax) {
    using T = Counted<float>;
    const auto input = [](float x) { return T(x); };
    const auto vec = [&](const Vec<float>& v) { return Vec<T>(input(v.x), input(v.y), input(v.z)); };
    OperationCounts found;
    intersect::for_each_form([&]<class Form>() {
        if (Form::info.name != form.name) return;
        const Ray<T> inputs{vec(ray.origin), vec(ray.direction)};
        const Solid<T> target = transformed(solid, input);
        operation_counts() = {};
        intersect::sdf::Unwatched unwatched;
        static_cast<void>(
            intersect::table::intersect_target<Form>(inputs, intersect::Target<T>(target), input(tmax), unwatched));
        found = operation_counts();
    });
    return found;
}

}  // namespace lostbits::measure::speed
