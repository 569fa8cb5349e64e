#include "measure/answer/levels.hpp"

#include <algorithm>
#include <cmath>

#include "intersect/space/spaced.hpp"
#include "measure/answer/asked.hpp"
#include "measure/truth/missing.hpp"
#include "measure/truth/truth.hpp"
#include "number/rounded.hpp"
#include "number/with_number.hpp"

namespace lostbits::measure::answer {

using intersect::space::Space;
using intersect::table::Intersector;

namespace {

/// A ray and the solid that it is held against, in numbers of the format.
struct Place {
    Ray<double> ray;
    Solid<double> solid;
    Range<double> range;
};

Place object_of(const Space& space, const Format& format, const Place& world) {
    return with_number(format, [&]<class T>() {
        const auto lift = [](double x) { return static_cast<T>(x); };
        const auto vec = [&](const Vec<double>& v) { return Vec<T>(lift(v.x), lift(v.y), lift(v.z)); };
        const auto back = [](const Vec<T>& v) { return Vec<double>(as_double(v.x), as_double(v.y), as_double(v.z)); };
        const auto& steps = intersect::space::steps_in<T>(space);
        const auto in = steps.to_object(steps.maps(transformed(*world.solid.placed, lift)),
                                        {vec(world.ray.origin), vec(world.ray.direction)});
        Solid<T> object = transformed(world.solid, lift);
        object.placed.reset();
        if (as_double(in.scale) != 1) object = scaled(object, in.scale);
        Place there{{back(in.ray.origin), back(in.ray.direction)},
                    transformed(object, [](const T& x) { return as_double(x); }),
                    world.range};
        there.range.tmin = as_double(lift(world.range.tmin) * in.length);
        there.range.tmax = as_double(lift(world.range.tmax) * in.length);
        return there;
    });
}

}  // namespace

Levels levels_of(const Intersector& row, const Format& format, const Ray<double>& ray, const Solid<double>& solid,
                 const Range<double>& range) {
    Levels found;
    Place at{ray, solid, range};
    bool is_lost = !ask_one(row, format, ray, solid, range.tmax);
    const auto lose = [&](Level level) {
        if (is_lost) found.lost_to = level;
        is_lost = false;
    };
    const Intersector* now = &row;
    for (;;) {
        if (const auto behind = intersect::hull::made_of(*now); behind.form != nullptr) {
            const Hull<double> box = behind.way->in(format, at.solid);
            found.boxes.push_back({at.ray, box});
            if (!ask_one(*behind.box, format, at.ray, box, at.range.tmax))
                lose(at.solid.placed ? Level::world_box : Level::box);
            now = behind.form;
        } else if (const auto through = intersect::space::made_of(*now); through.form != nullptr) {
            if (at.solid.placed) {
                at = object_of(*through.space, format, at);
                const auto words = now->info->convention().of(solid.shape);
                if (!truth::find_truth(at.ray, at.solid, {}, words, at.range).is_hit()) lose(Level::space);
            }
            now = through.form;
        } else {
            lose(Level::form);
            return found;
        }
    }
}

/// Tests of boxes grow with the end of the ray: k is doubled until the row hits, and then halved in between.
double end_margin(const Intersector& row, const Format& format, const Ray<double>& ray, const Solid<double>& solid,
                  const Range<double>& range) {
    const auto t = ask_one(row, format, ray, solid, range.tmax);
    if (!t || !std::isfinite(*t)) return truth::missing;
    const double ulp = std::ldexp(1, static_cast<int>(ulp_exponent(format.shape, *t == 0 ? -100000 : std::ilogb(*t))));
    const auto is_found = [&](double k) {
        const double end = rounding::to_format(*t + k * ulp, 0, format.shape);
        return ask_one(row, format, ray, solid, std::min(end, range.tmax)).has_value();
    };
    if (is_found(0)) return 0;
    double lost = 0, found = 1;
    for (; !is_found(found); found *= 2) {
        if (found > std::ldexp(1, format.shape.precision)) return HUGE_VAL;
        lost = found;
    }
    while (found - lost > 1) {
        const double between = std::floor((lost + found) / 2);
        (is_found(between) ? found : lost) = between;
    }
    return found;
}

}  // namespace lostbits::measure::answer
