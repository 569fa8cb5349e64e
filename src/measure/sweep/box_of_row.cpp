#include "measure/sweep/box_of_row.hpp"

#include "measure/metric/published_bounds.hpp"

namespace lostbits::measure::sweep {

double BoxOfRow::padding(const AxisColumns& columns, std::size_t i) {
    if (!same_ || columns.solid_varies()) same_ = box_around(columns.solid(i));
    return metric::padding(columns.ray_for(row_, i), *same_);
}

Box<float> BoxOfRow::box_around(const Solid<float>& solid) const {
    if (behind_.form == nullptr) return solid.box();
    static const Format binary32_format = *find_format("f32");
    const Hull<double> box =
        behind_.way->in(binary32_format, transformed(solid, [](float x) { return static_cast<double>(x); }));
    return transformed(Solid<double>(box), [](double x) { return static_cast<float>(x); }).box();
}

}  // namespace lostbits::measure::sweep
