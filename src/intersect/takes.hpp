// Which shape a form's `intersect` takes, for translation units that may include nothing heavier (see packed_kernels.hpp).
#pragma once

#include <type_traits>

#include "geometry/shapes.hpp"

namespace lostbits {

/// True of a form over spheres, false of one over boxes.
template <class Form>
inline constexpr bool takes_sphere = std::is_invocable_v<decltype(&Form::template intersect<float>), const Ray<float>&, const Sphere<float>&>;

}  // namespace lostbits
