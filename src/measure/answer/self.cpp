#include "measure/answer/self.hpp"

#include "measure/truth/enclose.hpp"

namespace lostbits::measure::answer {

using truth::Certified;

namespace {

/// True when this precision has the last word; `answer` is then set where there is one.
template <class E>
bool settle(const Hit<E>& hit, std::optional<Certified>& answer) {
    if (hit.hit.is_unknown()) return false;
    if (hit.hit.is_no()) return true;
    if (hit.t.undefined() == Undefined::always) return true;
    answer = truth::certify(hit.t);
    return answer.has_value();
}

}  // namespace

std::optional<Certified> without_rounding(const intersect::table::Intersector& form, const Ray<double>& ray,
                                          const intersect::Target<double>& target, int limit_bits) {
    std::optional<Certified> answer;
    const intersect::LiftedTarget<Ball> quick(target, [](double x) { return Ball(x); });
    if (settle(form.ball(lift_ray<Ball>(ray), quick.get()), answer)) return answer;
    for (int bits = 192; bits <= limit_bits; bits *= 2) {
        const Interval::Precision precision(bits);
        const intersect::LiftedTarget<Interval> lifted(target, [](double x) { return Interval(x); });
        if (settle(form.interval(lift_ray<Interval>(ray), lifted.get()), answer)) return answer;
    }
    return std::nullopt;
}

}  // namespace lostbits::measure::answer
