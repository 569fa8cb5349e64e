#include "intersect/table/rows.hpp"
#include "number/with_number.hpp"

namespace lostbits::intersect::table {
namespace {

template <class Form, class T>
MarchLog logged(const Ray<double>& ray, const Target<double>& target) {
    const auto lift = [](double x) { return static_cast<T>(x); };
    const auto vec = [lift](const Vec<double>& v) { return Vec<T>(lift(v.x), lift(v.y), lift(v.z)); };
    const LiftedTarget<T> lifted(target, lift);
    StepLog<T> log;
    const Hit<T> hit = intersect_target<Form>(Ray<T>{vec(ray.origin), vec(ray.direction)}, lifted.get(), T(0), log);
    const Stop stop = log.stop(hit, *lifted.get().march);
    return {log.take(), {hit.hit, as_double(hit.t), as_double(hit.near), as_double(hit.far)}, stop};
}

template <class Form>
MarchLog log_of(const Format& format, const Ray<double>& ray, const Target<double>& target) {
    return with_number(format, [&]<class T>() { return logged<Form, T>(ray, target); });
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
