// Rays for every form of every shape, and a form run on one of them through the plain rows of the table.
#pragma once

#include <cmath>
#include <vector>

#include "catch.hpp"
#include "intersect/table/table.hpp"
#include "measure/truth/band.hpp"
#include "number/random.hpp"
#include "number/rounded.hpp"

namespace lostbits::test {

/// Inputs of a form: a ray and its target.
struct Setting {
    Ray<double> ray;
    std::vector<Primitive<double>> primitives;
    intersect::MarchConstants<double> march{};
    double tmax = HUGE_VAL;  ///< of the shapes that are told

    [[nodiscard]] intersect::Target<double> target(const intersect::table::Intersector& form) const {
        return form.shape == Shape::sdf ? intersect::Target<double>(primitives, march)
                                        : intersect::Target<double>(primitives.front());
    }
};

/// A ray from outside or inside at a primitive of the form's shape (two primitives for a field); most rays hit, and
/// every number is one of the format. `far` multiplies the distance. Unit directions have unit length except for their
/// rounding.
inline Setting draw_setting(Random& random, const intersect::table::Intersector& form, const Format& format,
                            double far) {
    const auto in_format = [&](double x) { return rounding::to_format(x, 0, format.parameters); };
    const auto any = [&] { return 2 * random.unit() - 1; };
    const auto vec = [&](double scale) {
        return Vec<double>(in_format(scale * any()), in_format(scale * any()), in_format(scale * any()));
    };
    Setting s{{Vec<double>(0, 0, 0), Vec<double>(0, 0, 0)}, {}};
    const Vec<double> centre = vec(3);
    const double radius = in_format(0.3 + random.unit());
    const Vec<double> half(in_format(0.2 + random.unit()), in_format(0.2 + random.unit()),
                           in_format(0.2 + random.unit()));
    const auto box_at = [&](const Vec<double>& at) {
        Box<double> box{at, at};
        for (int i = 0; i < 3; ++i) {
            box.lo[i] = in_format(at[i] - half[i]);
            box.hi[i] = in_format(at[i] + half[i]);
        }
        return Primitive<double>(box);
    };
    const auto vertex = [&](double x, double y, double z) {
        return Vec<double>(in_format(centre.x + 2 * radius * x), in_format(centre.y + 2 * radius * y),
                           in_format(centre.z + 2 * radius * z));
    };
    if (form.shape == Shape::box) s.primitives.push_back(box_at(centre));
    else if (form.shape == Shape::triangle)
        s.primitives.push_back(Triangle<double>{vertex(1, -1, 0.25), vertex(-1, 0.5, 1), vertex(0.125, 1, -1)});
    else if (form.shape == Shape::ellipsoid) s.primitives.push_back(Ellipsoid<double>{centre, half});
    else if (is_primitive(form.shape))
        s.primitives.push_back(convert_numbers(primitive_around<double>(form.shape, centre, radius), in_format));
    else s.primitives.push_back(Sphere<double>{centre, radius});
    if (form.shape == Shape::sdf) s.primitives.push_back(box_at(vec(3)));
    s.ray.origin = Vec<double>(in_format(far * 6 * any()), in_format(far * 6 * any()), in_format(far * 6 * any()));
    const Vec<double> aim = vec(0.8);
    Vec<double> d(centre.x + aim.x * radius - s.ray.origin.x, centre.y + aim.y * radius - s.ray.origin.y,
                  centre.z + aim.z * radius - s.ray.origin.z);
    const double size = form.info->direction == intersect::Direction::unit
                            ? std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z)
                            : std::fabs(d.x) * (1 + random.unit());
    for (int i = 0; i < 3; ++i) s.ray.direction[i] = in_format(d[i] / size);
    s.march = intersect::MarchConstants<double>{in_format(1e-3), in_format(100), in_format(1e-3), in_format(1e-3),
                                                in_format(1.4)};
    return s;
}

/// Rays on which forms are recorded.
struct RecordedRays {
    std::vector<const char*> formats;
    int count;  ///< of each form in each format that it exists in
    double far = 1;
    std::uint64_t seed = 2026;
    std::span<const intersect::table::Intersector> forms = intersect::table::intersectors();
};

/// Calls `see(form, format, setting, tape)` for all of them.
template <class See>
void on_recorded_rays(const RecordedRays& of, const See& see) {
    for (const char* const name : of.formats) {
        const Format format = *find_format(name);
        for (const intersect::table::Intersector& form : of.forms) {
            if (!form.exists_in(format)) continue;
            Random random(of.seed);
            for (int i = 0; i < of.count; ++i) {
                const Setting s = draw_setting(random, form, format, of.far);
                Tape tape;
                form.record(format, s.ray, s.target(form), HUGE_VAL, tape);
                INFO(form.info->name << " in " << name << ", ray " << i);
                see(form, format, s, tape);
            }
        }
    }
}

/// The answer of the plain row.
inline Hit<double> plain(const intersect::table::Intersector& form, const Format& format, const Setting& setting) {
    const auto run = [&]<class S>(const auto& kernel) {
        const auto narrow = [](double x) { return static_cast<S>(x); };
        std::array<S, 11> x{narrow(setting.ray.origin.x),    narrow(setting.ray.origin.y),
                            narrow(setting.ray.origin.z),    narrow(setting.ray.direction.x),
                            narrow(setting.ray.direction.y), narrow(setting.ray.direction.z)};
        x[10] = narrow(setting.tmax);
        std::uint8_t hit = 0;
        const auto one = [&](std::size_t i) { return std::span<S>(&x[i], 1); };
        const intersect::LiftedTarget<S> target(setting.target(form));
        kernel(intersect::table::RayBatch<S>{one(0), one(1), one(2), one(3), one(4), one(5), one(10)}, target.get(),
               intersect::table::HitBatch<S>{one(6), one(7), one(8), std::span(&hit, 1)});
        return Hit<double>{hit != 0, x[6], x[7], x[8]};
    };
    switch (format.engine) {
        case Format::Engine::native32: return run.template operator()<float>(form.native32);
        case Format::Engine::native64: return run.template operator()<double>(form.native64);
        case Format::Engine::rounded: break;
    }
    return run.template operator()<double>([&](const auto&... a) { form.rounded(format.parameters, a...); });
}

}  // namespace lostbits::test
