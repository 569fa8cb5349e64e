// Why a march ended: `stagnated` is right for every limit on the steps.
#include "catch.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/sdf/sdf_draw.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::test::test_stop {

using intersect::StopReason;
using intersect::table::MarchLog;

namespace {

/// A sphere about the origin, seen from `eye` along a direction that is unit to binary32's rounding.
DrawnField towards_the_origin(const Vec<double>& eye, double radius, double hit_eps) {
    const auto stored = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    DrawnField field;
    field.primitives = {Primitive<double>(Sphere<double>{{0, 0, 0}, stored(radius)})};
    const double far = length(eye);
    field.march = {stored(hit_eps), stored(4 * far), stored(1e-9), stored(1e-9), stored(1.4), 1, 2, 4};
    field.rays = {{eye, {stored(-eye.x / far), stored(-eye.y / far), stored(-eye.z / far)}}};
    return field;
}

MarchLog capped(const intersect::table::Intersector& row, DrawnField& field, int max_steps, const char* format) {
    field.march.max_steps = max_steps;
    return row.log(*find_format(format), field.rays[0], field.target());
}

const intersect::table::Intersector& form(std::string_view name) {
    for (const intersect::table::Intersector& row : intersect::table::intersectors(Shape::sdf)) {
        if (row.info->name == name) return row;
    }
    throw std::logic_error("no such form");
}

/// The march of the lesson SDF Sphere Marching, in float, and why it ends.
StopReason plain_stop(const DrawnField& field, int max_steps) {
    const auto f = [](double x) { return static_cast<float>(x); };
    const Ray<double>& r = field.rays[0];
    const float radius = f(field.primitives[0].sphere().radius);
    volatile float t = 0, before = 0;  // stored, so that no wider register keeps it
    for (int i = 0; i < max_steps; ++i) {
        const float x = f(r.origin.x) + t * f(r.direction.x), y = f(r.origin.y) + t * f(r.direction.y),
                    z = f(r.origin.z) + t * f(r.direction.z);
        const float d = std::sqrt(x * x + y * y + z * z) - radius;
        if (d < f(field.march.hit_eps)) return StopReason::hit;
        before = t;
        t = t + d;
        if (t > f(field.march.max_dist)) return StopReason::max_dist;
    }
    return t == before ? StopReason::stagnated : StopReason::max_steps;
}

}  // namespace

TEST_CASE("a march that stops advancing at its last sample is stagnated", "[intersect][sdf]") {
    // t = 8192 − 0.9999 rounds to a multiple of 2^-11, and the remaining distance, 1e-4, is less than half of that.
    DrawnField field = towards_the_origin({-8192, 0, 0}, 0.9999, 1e-5);
    const auto stop = [&](const char* name, int cap) { return capped(form(name), field, cap, "f32").stop; };
    CHECK(stop("sdf.sphere_trace", 1) == StopReason::max_steps);
    for (const int cap : {2, 3, 4, 50}) CHECK(stop("sdf.sphere_trace", cap) == StopReason::stagnated);
    // The first step of 1.4 d is taken back.
    for (const int cap : {1, 2}) CHECK(stop("sdf.over_relaxed", cap) == StopReason::max_steps);
    for (const int cap : {3, 4, 50}) CHECK(stop("sdf.over_relaxed", cap) == StopReason::stagnated);
    // Its t stands still there too, but its point is near 1 and moves on: it hits one sample later.
    const MarchLog log = capped(form("sdf.accumulated"), field, 3, "f32");
    REQUIRE(log.steps.size() == 3);
    CHECK(log.steps[2].t == log.steps[1].t);
    CHECK(log.steps[2].p.x != log.steps[1].p.x);
    CHECK(stop("sdf.accumulated", 2) == StopReason::max_steps);
    for (const int cap : {3, 4, 50}) CHECK(stop("sdf.accumulated", cap) == StopReason::hit);
    // The secant moves t even if the march missed; the march itself ended. So does a step beyond max_dist.
    CHECK(stop("sdf.secant_refined", 1) == StopReason::max_steps);
    CHECK(stop("sdf.secant_refined", 2) == StopReason::stagnated);
    field.march.max_dist = 8000;
    for (const int cap : {1, 2}) CHECK(stop("sdf.sphere_trace", cap) == StopReason::max_dist);
}

TEST_CASE("a NaN on the way makes a march end at max_steps, not stagnate", "[intersect][sdf]") {
    DrawnField field = towards_the_origin({-4, 0, 0}, 1, 1e-5);
    field.rays[0].origin.y = std::nan("");
    for (const intersect::table::Intersector& row : intersect::table::intersectors(Shape::sdf)) {
        for (const int cap : {1, 2, 7}) CHECK(capped(row, field, cap, "f32").stop == StopReason::max_steps);
    }
}

TEST_CASE("a stagnated march stays where it is, and one at max_steps would move on", "[intersect][sdf]") {
    Random random(17);
    std::array<int, intersect::stop_names.size()> seen{};
    int at_last_sample = 0;
    for (int k = 0; k < 60; ++k) {
        const double far = std::ldexp(1 + random.unit(), static_cast<int>(random.between(1, 14)));
        const Vec<double> aim(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5);
        const auto stored = [](double x) { return static_cast<double>(static_cast<float>(x)); };
        const Vec<double> eye(stored(far * aim.x), stored(far * aim.y), stored(far * aim.z));
        DrawnField field = towards_the_origin(eye, 0.25 * (1 + random.unit()), std::ldexp(1, k % 2 == 0 ? -40 : -14));
        for (const intersect::table::Intersector& row : intersect::table::intersectors(Shape::sdf)) {
            for (const char* format : {"f32", "fp16"}) {
                bool stood = false;
                for (int cap = 1; cap <= 24; ++cap) {
                    const MarchLog log = capped(row, field, cap, format);
                    INFO(row.info->name << " in " << format << ", ray " << k << ", cap " << cap);
                    ++seen[static_cast<std::size_t>(log.stop)];
                    if (row.info->name == "sdf.sphere_trace" && format == std::string("f32"))
                        CHECK(log.stop == plain_stop(field, cap));
                    CHECK((!stood || log.stop == StopReason::stagnated));
                    if (log.stop != StopReason::stagnated && log.stop != StopReason::max_steps) continue;
                    REQUIRE(static_cast<int>(log.steps.size()) == cap);
                    const MarchLog more = capped(row, field, cap + 1, format), most = capped(row, field, 90, format);
                    const auto &last = log.steps.back(), &next = more.steps.back();
                    const bool same = last.t == next.t && last.p.x == next.p.x && last.p.y == next.p.y &&
                                      last.p.z == next.p.z && last.d == next.d;
                    CHECK(same == (log.stop == StopReason::stagnated));
                    if (log.stop == StopReason::max_steps) continue;
                    at_last_sample += !stood;
                    stood = true;
                    CHECK(most.stop == StopReason::stagnated);
                    CHECK_FALSE(most.hit.hit);
                    CHECK(most.hit.t == log.hit.t);
                }
            }
        }
    }
    for (const int count : seen) CHECK(count > 100);
    CHECK(at_last_sample > 100);
}

}  // namespace lostbits::test::test_stop
