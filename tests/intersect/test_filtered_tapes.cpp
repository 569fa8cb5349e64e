// The tape of a form that filters records what ran, with its exact step as one operation. It has the same bits on rays
// that break filters, at every scale, and the same answer without rounding.
#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/hostile_rays.hpp"
#include "measure/attribution/attribution.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "number/oracle.hpp"

namespace lostbits::test::test_filtered_tapes {
namespace {

using intersect::DecidingArithmetic;
using intersect::table::Intersector;

struct Tally {
    std::atomic<std::uint64_t> ray_count = 0, exact = 0, shared_out = 0, hits = 0;
    std::atomic<std::uint64_t> other_bits = 0, other_way = 0, turned = 0, inexact = 0, of_constants = 0;
};

/// Triangle of three corners of a box. Rays through edges and corners of the box meet the triangle's own.
HostileRay at_triangle(const HostileRay& x) {
    const Box<double> box = x.primitive.box();
    const Vec<double> third(box.lo.x, box.hi.y, box.lo.z);
    return {x.ray, Triangle<double>{box.lo, box.hi, third}};
}

/// True if each of its arithmetics is on the tape. For a form that filters by a span, everything after the first is one
/// call.
bool asks_steps(const Intersector& form) {
    return form.shape == Shape::sphere || form.shape == Shape::box || form.shape == Shape::triangle;
}

HostileRay in_format(const HostileRay& x, const FloatFormat& format) {
    const auto rounded = [&](double v) { return rounding::to_format(v, 0, format); };
    const auto vec = [&](const Vec<double>& v) { return Vec<double>(rounded(v.x), rounded(v.y), rounded(v.z)); };
    return {{vec(x.ray.origin), vec(x.ray.direction)}, convert_numbers(x.primitive, rounded), rounded(x.tmax)};
}

/// Without rounding, the exact step gives its own decision, and a t at most 16u from its own.
void check_exact_step(const Tape& tape, const Format& format, bool hit, Tally& tally) {
    const measure::attribution::Attribution found = measure::attribution::attribute(tape, {.full = true});
    ++tally.shared_out;
    tally.turned += found.is_exact_hit != hit;
    if (found.culprit != no_node) tally.of_constants += tape[found.culprit].op == TapeOp::constant;
    if (!hit) return;
    ++tally.hits;
    const double t = tape[tape.outputs.t].value, off = found[tape.outputs.t].error;
    const double allowed = 16 * std::ldexp(std::fabs(t), -format.parameters.precision) +
                           measure::attribution::ulp_at(0, format.parameters);
    tally.inexact += std::isfinite(t) && !(std::fabs(off) <= allowed);
}

/// Number of rays with an exact step on the tape that are still to be attributed; attributing them takes longer than
/// all else.
struct Shares {
    int hits, misses;
    bool take(bool hit) { return (hit ? hits : misses)-- > 0; }
};

void check_ray(const Intersector& form, const Format& format, const HostileRay& x, Shares& shares, Tally& tally) {
    const Setting s{.ray = x.ray, .primitives = {x.primitive}, .tmax = x.tmax};
    const Hit<double> want = plain(form, format, s);
    Tape tape;
    form.record(format, s.ray, s.target(form), s.tmax, tape);
    const auto [hit, t, near, far] = tape.outputs;
    ++tally.ray_count;
    tally.other_bits += (tape[hit].value != 0) != want.hit || !same_number(tape[t].value, want.t) ||
                        !same_number(tape[near].value, want.near) || !same_number(tape[far].value, want.far);
    const DecidingArithmetic way = form.deciding_arithmetic(format, s.ray, s.target(form), s.tmax);
    const bool exact = way == DecidingArithmetic::exact || (way != DecidingArithmetic::own && !asks_steps(form));
    tally.exact += exact;
    tally.other_way += exact == tape.calls.empty();
    if (exact && shares.take(want.hit)) check_exact_step(tape, format, want.hit, tally);
}

template <class S>
void check_form(const Intersector& form, const Format& format, std::uint64_t rays, bool any_scale) {
    Tally tally;
    const std::uint64_t block = form.shape == Shape::torus ? 128 : 512;
    tbb::parallel_for(std::uint64_t{0}, rays / block, [&](std::uint64_t b) {
        HostileRays<S> draw(2031 << 20 | b);
        Random scales(b);
        // Attributing a call of a torus takes a second.
        Shares shares = form.shape != Shape::torus ? Shares{3, 1} : Shares{b % 4 == 0 ? 1 : 0, 0};
        for (std::uint64_t i = 0; i < block; ++i) {
            const bool as_box = form.shape == Shape::box || form.shape == Shape::triangle;
            HostileRay x = as_box ? draw.box((b + i) % hostile_box_distributions.size())
                                  : draw.sphere((b + i) % sphere_distributions.size());
            if (form.shape == Shape::triangle) x = at_triangle(x);
            else if (!asks_steps(form))
                x.primitive = primitive_around<double>(form.shape, x.primitive.point(0), x.primitive.numbers[3]);
            if (any_scale) x = at_any_scale<S>(x, scales);
            x = in_format(x, format.parameters);
            // At any scale the ends of an axis may meet, and a normal vanish.
            if (asks_steps(form) || !broken_limit(x.primitive)) check_ray(form, format, x, shares, tally);
        }
    });
    INFO(form.info->name << " in " << format.name << (any_scale ? " at any scale" : "") << ": " << tally.ray_count
                         << " rays, " << tally.exact << " settled exactly, " << tally.shared_out << " shared out, "
                         << tally.hits << " of them hits");
    CHECK(tally.other_bits == 0);
    CHECK(tally.other_way == 0);
    CHECK(tally.turned == 0);
    CHECK(tally.inexact == 0);
    CHECK(tally.of_constants == 0);
    CHECK(tally.exact > tally.ray_count / 128);
    CHECK(tally.hits > 0);
}

}  // namespace

TEST_CASE("the tape of a filtered form records what ran, with its exact step as one operation", "[attribution]") {
    std::size_t forms = 0;
    for (const Intersector& form : intersect::table::catalogue()) {
        if (!form.deciding_arithmetic) continue;
        ++forms;
        for (const bool any_scale : {false, true}) {
            // Rays that a span leaves open need intervals of many bits, which for a torus take a hundred times as long.
            const bool slow = form.shape == Shape::torus;
            // Few hits of a plane are decided exactly.
            const bool quick = asks_steps(form) || form.shape == Shape::plane;
            const std::uint64_t rays = asks_steps(form) ? draws(1 << 18, 40)
                                       : slow           ? draws(1 << 13, 64)
                                                        : draws(1 << 16, 40),
                                narrow = slow ? draws(1 << 12, 32) : draws(1 << 15, quick ? 32 : 64);
            check_form<float>(form, *find_format("f32"), rays, any_scale);
            check_form<double>(form, *find_format("f64"), rays, any_scale);
            check_form<float>(form, *find_format("p20"), narrow, any_scale);
        }
    }
    CHECK(forms == 11);
}

}  // namespace lostbits::test::test_filtered_tapes
