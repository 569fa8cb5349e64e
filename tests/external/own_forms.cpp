// Copies of the catalogue's forms as a library of formulas. All their measurements must be the same as for the
// originals. Two more forms misbehave.
#include <lostbits_form.hpp>

#include <stdexcept>

#include "intersect/sdf/secant_refined.hpp"
#include "shapes/box/forms/inclusive.hpp"
#include "shapes/sphere/forms/double_inside.hpp"
#include "shapes/sphere/forms/schoolbook.hpp"
#include "shapes/sphere/forms/unified.hpp"

using namespace lostbits;

namespace {

/// A form under another name.
template <class Form>
constexpr intersect::Info renamed(std::string_view name) {
    intersect::Info info = Form::info;
    info.name = name;
    return info;
}

struct Unified : intersect::sphere::Unified {
    static constexpr intersect::Info info = renamed<intersect::sphere::Unified>("own.unified");
};
struct DoubleInside : intersect::sphere::DoubleInside {
    static constexpr intersect::Info info = renamed<intersect::sphere::DoubleInside>("own.double_inside");
};
struct Inclusive : intersect::box::Inclusive {
    static constexpr intersect::Info info = renamed<intersect::box::Inclusive>("own.inclusive");
};
struct SecantRefined : intersect::sdf::SecantRefined {
    static constexpr intersect::Info info = renamed<intersect::sdf::SecantRefined>("own.secant_refined");
};

/// Returns both roots, and a t that is |near| from inside, which contradicts near and far.
struct SizeOfNear {
    static constexpr intersect::Info info{.name = "own.size_of_near"};
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        Hit<T> hit = intersect::sphere::Unified::intersect(ray, sphere);
        hit.t = abs(hit.near);
        return hit;
    }
};
/// Is wrong by a factor, and by the cancellation of the schoolbook form.
struct Twice {
    static constexpr intersect::Info info{.name = "own.twice"};
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Hit<T> hit = intersect::sphere::Schoolbook::intersect(ray, sphere);
        return {hit.hit, hit.near * T(2), hit.far * T(2), hit.t * T(2)};
    }
};
/// Stops early because of its own bound.
struct GivesUp {
    static constexpr intersect::Info info{.name = "own.gives_up"};
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T h = dot(f, ray.direction), c = dot(f, f) - sphere.radius * sphere.radius;
        const T disc = named("disc", h * h - c);
        const T root = sqrt(disc);
        return {!(disc < T(1) / T(1000) || root < h), -h - root, root - h, -h - root};
    }
};
struct Crashes {
    static constexpr intersect::Info info{.name = "own.crashes"};
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        if constexpr (is_exact<T>) *static_cast<volatile int*>(nullptr) = 1;
        return intersect::sphere::Unified::intersect(ray, sphere);
    }
};
struct Throws {
    static constexpr intersect::Info info{.name = "own.throws"};
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        if constexpr (is_exact<T>) throw std::runtime_error("no bananas");
        return intersect::sphere::Unified::intersect(ray, sphere);
    }
};
struct Hangs {
    static constexpr intersect::Info info{.name = "own.hangs"};
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        for (volatile bool again = !is_exact<T>; again;) {}
        return intersect::sphere::Unified::intersect(ray, sphere);
    }
};

}  // namespace

LOSTBITS_FORMULAS(Unified, DoubleInside, Inclusive, SecantRefined, SizeOfNear, Twice, GivesUp, Crashes, Throws, Hangs)
