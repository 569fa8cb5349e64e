#include "intersect/table/rows.hpp"
#include "number/rounded.hpp"

namespace lostbits::intersect::table {
namespace {

template <class Form, class T, class Lift, class Drop>
MarchLog logged(const Ray<double>& ray, const Target<double>& target, Lift lift, Drop drop) {
    const auto vec = [lift](const Vec<double>& v) { return Vec<T>(lift(v.x), lift(v.y), lift(v.z)); };
    const LiftedTarget<T> lifted(target, lift);
    StepLog<T, Drop> log(drop);
    const Hit<T> hit = intersect_target<Form>(Ray<T>{vec(ray.origin), vec(ray.direction)}, lifted.get(), T(0), log);
    const auto number = [drop](const T& x) { return static_cast<double>(drop(x)); };
    return {log.take(), {hit.hit, number(hit.t), number(hit.near), number(hit.far)}};
}

template <class Form>
MarchLog log_of(const Format& format, const Ray<double>& ray, const Target<double>& target) {
    switch (format.engine) {
        case Format::Engine::native32:
            return logged<Form, float>(
                ray, target, [](double x) { return static_cast<float>(x); }, [](float x) { return x; });
        case Format::Engine::native64:
            return logged<Form, double>(
                ray, target, [](double x) { return x; }, [](double x) { return x; });
        case Format::Engine::rounded: break;
    }
    const CurrentFormat::Scope scope(format.shape);
    return logged<Form, RoundedAny>(
        ray, target, [](double x) { return RoundedAny(x); }, [](RoundedAny x) { return x.value(); });
}

}  // namespace

void fill_logs(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        if constexpr (shape_of<Form> == Shape::sdf) rows[i].log = log_of<Form>;
        ++i;
    });
}

}  // namespace lostbits::intersect::table
