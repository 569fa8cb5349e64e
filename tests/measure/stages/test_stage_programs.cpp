// A recorded stage that runs over columns gives every word and bound that its formula gives over one double: for every
// shape, with and without ranges, matrices and second words, with columns of one number and of many.
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "catch.hpp"
#include "measure/stages/stage_formula.hpp"
#include "measure/stages/stages.hpp"
#include "measure/widths.hpp"
#include "shapes/primitive.hpp"

namespace test_stage_programs {

using namespace lostbits;
using namespace lostbits::measure::stages;
using number::wide::TwoWords;

namespace {

constexpr std::size_t rays = 416;  // three blocks and a quarter

double drawn(std::mt19937_64& from, double low, double high) {
    return low + (high - low) * static_cast<double>(from() >> 11) * 0x1p-53;
}

/// Rays at a primitive near the origin, from everywhere: some begin inside, some pass by, some run along an axis. Every
/// fifth ray points away, and so does the whole second block, after which a program skips steps that no ray needs.
std::vector<std::array<double, stage_input_count>> problems_at(Shape shape) {
    std::mt19937_64 from(23);
    std::vector<std::array<double, stage_input_count>> all(rays);
    for (std::size_t i = 0; i < rays; ++i) {
        auto& p = all[i];
        const auto spread = [&](double size) { return drawn(from, -size, size); };
        Primitive<double> primitive(shape);
        Primitives::each([&]<template <class> class Of>() {
            if (shape_as<Of> == shape)
                primitive = Primitive<double>(
                    Of<double>::around(Vec<double>(spread(0.5), spread(0.5), spread(0.5)), drawn(from, 1, 2)));
        });
        const Vec<double> origin(spread(4), spread(4), spread(4)), aim(spread(1.5), spread(1.5), spread(1.5));
        const bool away = i % 5 == 4 || i / 128 == 1;
        for (int k = 0; k < 3; ++k) {
            const auto at = input_of_ray + static_cast<std::size_t>(k);
            const double along = k == static_cast<int>(i / 8 % 3) ? 1 : 0;
            p[at] = away ? 3 * origin[k] : origin[k];
            p[at + 3] = away ? p[at] : i % 8 == 7 ? along : aim[k] - origin[k];
        }
        for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k)
            p[input_of_primitive + k] = primitive.numbers[k];
        for (std::size_t k = 0; k < Affine<double>::number_count; ++k)
            p[input_of_primitive + max_number_count + k] = (k % 5 == 0 ? 1.0 : 0.0) + spread(0.2);
        for (std::size_t k = 0; k < 6; ++k) p[input_of_ray_low + k] = p[input_of_ray + k] * 0x1p-55;
        for (std::size_t k = 0; k < max_primitive_number_count; ++k)
            p[input_of_primitive_low + k] = p[input_of_primitive + k] * -0x1.8p-56;
        p[input_of_tmin] = i % 3 == 0 ? 0 : drawn(from, 0, 3);
        p[input_of_tmax] = i % 4 == 0 ? HUGE_VAL : p[input_of_tmin] + drawn(from, 0.5, 6);
    }
    return all;
}

/// The numbers of problems as columns; a column of one number where `one_primitive`.
template <class S>
class ColumnsOfProblems {
public:
    ColumnsOfProblems(std::span<const std::array<double, stage_input_count>> problems, bool one_primitive) {
        for (std::size_t k = 0; k < stage_input_count; ++k)
            for (const auto& p : problems)
                columns_[k].push_back(static_cast<S>(is_of_primitive(k) && one_primitive ? problems.front()[k] : p[k]));
        one_primitive_ = one_primitive;
    }
    [[nodiscard]] RawProblems<S> raw(const StageKey& key) {
        RawFindings out{settled.data(), hit.data(), {}, {}};
        if (key.wants_t) out.t = {t[0].data(), t[1].data(), t[2].data()};
        if (key.wants_distance) out.distance = {distance[0].data(), distance[1].data(), distance[2].data()};
        auto p = make_raw_problems<S>(rays, out);
        const auto column = [this](std::size_t k) {
            return RawColumn<S>{columns_[k].data(),
                                is_of_primitive(k) && one_primitive_ ? std::size_t{0} : std::size_t{1}};
        };
        for (std::size_t k = 0; k < 6; ++k)
            p.ray[k] = column(input_of_ray + k), p.ray_low[k] = column(input_of_ray_low + k);
        for (std::size_t k = 0; k < max_primitive_number_count; ++k)
            p.primitive[k] = column(input_of_primitive + k), p.primitive_low[k] = column(input_of_primitive_low + k);
        p.tmin = column(input_of_tmin), p.tmax = column(input_of_tmax);
        p.two_words = key.two_words, p.has_ranges = key.has_ranges, p.open_ends = key.open_ends, p.matrix = key.matrix;
        return p;
    }
    [[nodiscard]] double at(std::size_t input, std::size_t i) const { return static_cast<double>(columns_[input][i]); }

    std::vector<std::uint8_t> settled = std::vector<std::uint8_t>(rays), hit = settled;
    std::array<std::vector<double>, 3> t = {std::vector<double>(rays), std::vector<double>(rays),
                                            std::vector<double>(rays)},
                                       distance = t;

private:
    static bool is_of_primitive(std::size_t k) {
        return (k >= input_of_primitive && k < input_of_ray_low) || (k >= input_of_primitive_low && k < input_of_tmin);
    }
    std::array<std::vector<S>, stage_input_count> columns_;
    bool one_primitive_ = false;
};

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

struct Counts {
    std::size_t settled = 0, different = 0;
};

/// The stage of a shape in columns of S, against its formula over words of W.
template <template <class> class Of, class S, class W>
Counts compare(const StageKey& key, bool one_primitive, const ShapeStage<S>& stage,
               std::span<const std::array<double, stage_input_count>> problems) {
    ColumnsOfProblems<S> columns(problems, one_primitive);
    stage(columns.raw(key));
    Counts counts;
    for (std::size_t i = 0; i < rays; ++i) {
        const Finding<double> alone = settle_inputs<Of, W>(key, [&](std::size_t k) { return columns.at(k, i); });
        counts.settled += alone.settled ? 1 : 0;
        bool same = columns.settled[i] == static_cast<std::uint8_t>(alone.settled);
        // Nothing reads the hit of a ray that is not settled.
        if (alone.settled) {
            same = same && columns.hit[i] == static_cast<std::uint8_t>(alone.hit);
            const auto length = [&](const Enclosure<double>& x, const std::array<std::vector<double>, 3>& found) {
                const double wanted[3] = {x.middle.hi, x.middle.lo, x.bound};
                for (std::size_t k = 0; k < 3; ++k) same = same && same_bits(found[k][i], alone.hit ? wanted[k] : 0.0);
            };
            if (key.wants_t) length(alone.t, columns.t);
            if (key.wants_distance) length(alone.distance, columns.distance);
        }
        counts.different += same ? 0 : 1;
    }
    return counts;
}

/// Each feature that changes a program, alone and with others.
std::vector<StageKey> keys_of(Shape shape, int words) {
    const StageKey plain{shape, words, false, {}, false, {}, true, true};
    std::vector<StageKey> all{plain, plain, plain, plain, plain, plain, plain};
    all[1].has_ranges = true;
    all[2].has_ranges = true, all[2].open_ends = {true, true};
    all[3].matrix = {true, false, 1};
    all[4].matrix = {true, true, 1}, all[4].has_ranges = true;
    all[5].wants_distance = false;
    all[6].two_words = words == 2, all[6].wants_t = false;
    return all;
}

}  // namespace

TEST_CASE("stage programs: every shape has the words and bounds of its formula at every register width") {
    test::at_every_width([](intersect::simd::Isa isa) {
        Primitives::each([&]<template <class> class Of>() {
            constexpr Shape shape = shape_as<Of>;
            const auto problems = problems_at(shape);
            const Stages stages = stages_of(shape, isa);
            for (const bool one_primitive : {false, true}) {
                for (const StageKey& key : keys_of(shape, 1)) {
                    INFO(row_of(shape).name << ", one word, one solid " << one_primitive << ", ranged "
                                            << key.has_ranges << ", matrix " << key.matrix.exists
                                            << key.matrix.is_inverse);
                    const Counts found = compare<Of, float, double>(key, one_primitive, stages.binary64, problems);
                    CHECK(found.different == 0);
                    CHECK(found.settled > rays / 2);
                }
                for (const StageKey& key : keys_of(shape, 2)) {
                    INFO(row_of(shape).name << ", two words, one solid " << one_primitive << ", ranged "
                                            << key.has_ranges << ", matrix " << key.matrix.exists
                                            << key.matrix.is_inverse << ", two words each " << key.two_words);
                    const Counts found =
                        compare<Of, double, TwoWords<double>>(key, one_primitive, stages.double_double, problems);
                    CHECK(found.different == 0);
                    CHECK(found.settled > rays / 2);
                }
            }
        });
    });
}

}  // namespace test_stage_programs
