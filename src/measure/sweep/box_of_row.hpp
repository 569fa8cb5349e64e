// The box that a form asks at the floats of an axis, and how far its slabs come apart there.
#pragma once

#include <optional>

#include "intersect/hull/behind.hpp"
#include "measure/sweep/axis_columns.hpp"
#include "measure/sweep/float_tally.hpp"

namespace lostbits::measure::sweep {

/// Of a form of boxes its solid, of a form behind a box that box; of others none.
class BoxOfRow {
public:
    explicit BoxOfRow(const evaluate::TestedForm& row) : row_(row), behind_(intersect::hull::made_of(*row.form)) {}

    [[nodiscard]] bool is_asked() const { return row_.form->shape == hull_shape || behind_.form != nullptr; }
    /// By how many u tmax must grow for the slabs of `box.signs` to overlap at float i: the metric `padding`.
    [[nodiscard]] double padding(const AxisColumns& columns, std::size_t i);

private:
    [[nodiscard]] Hull<float> box_around(const Solid<float>& solid) const;

    const evaluate::TestedForm& row_;
    intersect::hull::HullParts behind_;
    std::optional<Hull<float>> same_;  ///< where the axis leaves the solid as it is
};

/// By how many u tmax must grow so that no hit is missed for slabs that come apart; 0 where none is, missing for a form
/// that asks no box.
double padding_max(const evaluate::TestedForm& row, const FloatTally& tally);

}  // namespace lostbits::measure::sweep
