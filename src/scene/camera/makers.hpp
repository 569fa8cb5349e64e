// The table of ways to make a ray: each over floats, doubles, numbers of any format, and exact ones.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "number/real.hpp"
#include "number/rounded.hpp"
#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

/// Rows [first, last) of a picture.
struct Rows {
    int first, last;
};

/// The rays of every pixel of some rows, in the order of the pixels.
template <class T>
using MakeIn = void (*)(const CameraNumbers<T>&, Rows, const std::function<void(const Ray<T>&)>& take);

struct Maker {
    const MakerInfo* info;
    MakeIn<float> f32;
    MakeIn<double> f64;
    MakeIn<RoundedAny> rounded;
    MakeIn<Real> real;
};

/// In the order of the list.
std::span<const Maker> makers();
/// Null where none has that name.
const Maker* find_maker(std::string_view name);

}  // namespace lostbits::scene::camera
