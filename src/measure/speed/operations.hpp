// What a form costs in operations.
#pragma once

#include "intersect/table/table.hpp"
#include "number/counted.hpp"

namespace lostbits::measure::speed {

/// The operations of one evaluation in binary32, as the form is written (see `Counted`). Forms select and do not
/// branch, so only those that iterate depend on the ray. All zero for a form that is not in the catalogue.
OperationCounts operations_of(const intersect::Info& form, const Ray<float>& ray, const Solid<float>& solid,
                              float tmax);

}  // namespace lostbits::measure::speed
