#include "measure/answer/without_rounding.hpp"

#include <algorithm>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/truth/enclose.hpp"

namespace lostbits::measure::answer {

using truth::CertifiedNumber;

namespace {

/// Returns true if the precision of `hit` decides the form's answer, and sets `answer` if there is one.
template <class E>
bool try_to_answer(const Hit<E>& hit, std::optional<CertifiedNumber>& answer) {
    if (hit.hit.is_unknown()) return false;
    if (hit.hit.is_no()) return true;
    if (hit.t.undefined() == Undefined::always) return true;
    answer = truth::certify(hit.t);
    return answer.has_value();
}

}  // namespace

std::optional<CertifiedNumber> evaluate_exactly(const intersect::table::Intersector& form, const Ray<double>& ray,
                                                const intersect::Target<double>& target, int limit_bits) {
    std::optional<CertifiedNumber> answer;
    const intersect::LiftedTarget<Ball> ball_target(target);
    if (try_to_answer(form.ball(lift_ray<Ball>(ray), ball_target.get()), answer)) return answer;
    for (int bits = 192; bits <= limit_bits; bits *= 2) {
        const Interval::Precision precision(bits);
        const intersect::LiftedTarget<Interval> interval_target(target);
        if (try_to_answer(form.interval(lift_ray<Interval>(ray), interval_target.get()), answer)) return answer;
    }
    return std::nullopt;
}

namespace {

using intersect::table::Intersector;
using Real2048 = BasicReal<2048>;

const Intersector& form_of(const Call& call) {
    return *std::ranges::find(intersect::table::catalogue(), call.form, [](const auto& f) { return f.info->name; });
}

/// Answers a call. `numbers` are those of the ray and the primitive; `end` is the end of the ray, if it has one. Calls
/// `ask(form, ray, target)`. A decision is a number too: 1 for a hit and -1 for a miss; the t of a miss is -1.
template <class E, class Ask>
std::optional<E> answer_call(const Call& call, std::span<const E> numbers, const std::optional<E>& end,
                             const Ask& ask) {
    const Intersector& form = form_of(call);
    const auto vec = [&](std::size_t k) { return Vec<E>(numbers[k], numbers[k + 1], numbers[k + 2]); };
    Primitive<E> primitive(form.shape);
    std::ranges::copy(numbers.subspan(6), primitive.numbers.begin());
    Hit<E> hit = ask(form, Ray<E>{vec(0), vec(3)}, intersect::Target<E>(primitive));
    if (end) {
        hit.hit = hit.hit && hit.near <= *end;
        hit.far = min(hit.far, *end);
    }
    if (hit.hit.is_unknown()) return std::nullopt;
    if (call.answer == CallAnswer::decision) return E(hit.hit.is_yes() ? 1 : -1);
    if (call.answer == CallAnswer::t && hit.hit.is_no()) return E(-1);
    const E& value = call.answer == CallAnswer::t ? hit.t : call.answer == CallAnswer::near ? hit.near : hit.far;
    return value.is_bounded() ? std::optional(value) : std::nullopt;
}

/// Number of arguments that describe the ray and the primitive; the end of the ray may follow them.
std::size_t count_numbers(const Call& call) {
    return 6 + Primitive<double>(form_of(call).shape).shape_numbers().size();
}

/// Converts x exactly, as a sum of doubles.
Interval exact_interval(Real2048 x) {
    Interval sum(0);
    while (mpfr_regular_p(x.backend().data()) != 0) {
        const double part = mpfr_get_d(x.backend().data(), MPFR_RNDN);
        if (part == 0) break;
        sum += Interval(part);
        x -= Real2048(part);
    }
    return sum;
}

}  // namespace

std::optional<Ball> evaluate_exactly(const Call& call, std::span<const Ball> arguments) {
    const std::size_t count = count_numbers(call);
    std::optional<Ball> end;
    if (arguments.size() > count && arguments.back().hi() < 0x1p880) end = arguments.back();
    return answer_call<Ball>(
        call, arguments.first(count), end,
        [](const Intersector& form, const auto& ray, const auto& target) { return form.ball(ray, target); });
}

std::optional<Real2048> evaluate_exactly(const Call& call, std::span<const Real2048> arguments) {
    // 10240 bits: a decision takes products of four numbers of 2048 bits.
    const Interval::Precision precision(10240);
    std::vector<Interval> lifted;
    for (const Real2048& x : arguments) lifted.push_back(exact_interval(x));
    const std::size_t count = count_numbers(call);
    std::optional<Interval> end;
    if (arguments.size() > count && mpfr_inf_p(arguments.back().backend().data()) == 0) end = lifted.back();
    const auto enclosure = answer_call<Interval>(
        call, std::span<const Interval>(lifted).first(count), end,
        [](const Intersector& form, const auto& ray, const auto& target) { return form.interval(ray, target); });
    if (!enclosure) return std::nullopt;
    Real2048 value;
    mpfr_set(value.backend().data(), enclosure->lower(), MPFR_RNDN);
    return value;
}

}  // namespace lostbits::measure::answer
