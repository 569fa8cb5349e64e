#include "measure/sweep/box_of_row.hpp"

#include "measure/metric/published_bounds.hpp"

namespace lostbits::measure::sweep {

double BoxOfRow::padding(const AxisColumns& columns, std::size_t i) {
    if (!same_ || columns.solid_varies()) same_ = box_around(columns.solid(i));
    return metric::padding(columns.ray_for(row_, i), *same_);
}

Hull<float> BoxOfRow::box_around(const Solid<float>& solid) const {
    if (behind_.form == nullptr) return hull_of(solid);
    static const Format in_binary32 = *find_format("f32");
    const auto [lo, hi] =
        behind_.way->in(in_binary32, transformed(solid, [](float x) { return static_cast<double>(x); }));
    const auto narrow = [](const Vec<double>& v) {
        return Vec<float>(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
    };
    return {narrow(lo), narrow(hi)};
}

double padding_max(const evaluate::TestedForm& row, const FloatTally& tally) {
    if (!BoxOfRow(row).is_asked()) return truth::missing;
    return tally.padding ? tally.padding->u : 0;
}

}  // namespace lostbits::measure::sweep
