// The table of ways to make a ray: each over floats, doubles, numbers of any format, and exact ones.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>

#include "number/format.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"
#include "number/tape.hpp"
#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

/// Rows [first, last) of a picture.
struct Rows {
    int first, last;
};

/// The rays of every pixel of some rows, in the order of the pixels.
template <class T>
using MakeIn = void (*)(const CameraNumbers<T>&, Rows, const std::function<void(const Ray<T>&)>& take);

/// A pixel by its whole numbers.
struct Place {
    int x, y;
};

/// Every operation that makes a ray in a format, onto a tape whose inputs are the numbers of the camera, in the order
/// of `CameraNumbers::each`, and the x, y and left of the pixel; and where the ray's six numbers stand.
using RecordRay = std::array<NodeId, 6> (*)(const Format&, const CameraNumbers<double>&, Place, Tape&);

struct Maker {
    const MakerInfo* info;
    MakeIn<float> f32;
    MakeIn<double> f64;
    MakeIn<RoundedAny> rounded;
    MakeIn<Real> real;
    RecordRay record;
};

/// In the order of the list.
std::span<const Maker> makers();
/// Null where none has that name.
const Maker* find_maker(std::string_view name);

}  // namespace lostbits::scene::camera
