// Directions made unit in packs have the bits of each direction alone, at every register width.
#include <bit>
#include <cmath>
#include <vector>

#include "catch.hpp"
#include "measure/stages/stages.hpp"
#include "measure/truth/unit_direction.hpp"
#include "measure/widths.hpp"
#include "number/random.hpp"
#include "number/rounded.hpp"

namespace lostbits::test::test_unit_directions {

namespace {

using Columns = std::array<std::vector<double>, 3>;

/// Numbers of a format: of like size, of any size, zeros of both signs among them; whole multiples of an axis.
Columns directions_of(const FloatFormat& format, std::size_t n, Random& random, bool extreme) {
    Columns all;
    for (std::size_t i = 0; i < n; ++i) {
        for (auto& column : all) {
            const int e = static_cast<int>(random.between(extreme ? format.emin - 10 : -3, extreme ? format.emax : 3));
            double x = random.sign() * std::ldexp(random.one_in(4) ? 1 : 1 + random.unit(), e);
            if (random.one_in(8)) x = random.sign() * 0.0;
            if (extreme && random.one_in(40)) x = random.one_in(2) ? HUGE_VAL : std::nan("");
            column.push_back(rounding::to_format(x, 0, format));
        }
    }
    return all;
}

std::array<std::span<double>, 3> spans_of(Columns& all) { return {all[0], all[1], all[2]}; }

bool same(double x, double y) {
    return (std::isnan(x) && std::isnan(y)) || std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
}

}  // namespace

TEST_CASE("unit directions in packs equal those computed alone", "[measure][stages]") {
    test::at_every_width([](intersect::simd::Isa) {
        for (const bool extreme : {false, true}) {
            for (const FloatFormat& format : {binary32, binary64, FloatFormat{11, -14, 15}}) {
                Random random(7);
                Columns all = directions_of(format, 4099, random, extreme);
                const Columns given = all;
                measure::truth::make_unit(spans_of(all), format);
                std::size_t wrong = 0;
                for (std::size_t i = 0; i < given[0].size(); ++i) {
                    const Vec<double> want =
                        measure::truth::unit_direction({given[0][i], given[1][i], given[2][i]}, format);
                    for (int k = 0; k < 3; ++k) wrong += !same(all[k][i], want[k]);
                }
                INFO(format.precision << " bits" << (extreme ? ", extreme" : ""));
                CHECK(wrong == 0);
            }
        }
    });
}

TEST_CASE("packs decide nearly all unit directions, and none outside their range", "[measure][stages]") {
    test::at_every_width([](intersect::simd::Isa isa) {
        Random random(11);
        constexpr std::size_t n = 4096;
        Columns all = directions_of(binary64, n, random, false);
        std::vector<std::uint8_t> settled(n);
        Columns out;
        for (auto& column : out) column.resize(n);
        const auto count = [&](bool narrow, double scale) {
            const auto stages = measure::stages::stages_of(Shape::sphere, isa);
            stages.unit_directions({{all[0].data(), all[1].data(), all[2].data()},
                                    {out[0].data(), out[1].data(), out[2].data()},
                                    settled.data(),
                                    narrow,
                                    scale,
                                    n});
            return static_cast<std::size_t>(std::ranges::count(settled, 1));
        };
        std::size_t zeros = 0;
        for (std::size_t i = 0; i < n; ++i) zeros += all[0][i] == 0 && all[1][i] == 0 && all[2][i] == 0;
        for (const bool narrow : {false, true}) {
            CHECK(count(narrow, 1) == n - zeros);
            CHECK(count(narrow, 0x1p+60) < n / 8);  // along an axis the quotient is exact, and stays when widened
        }
        for (auto& column : all)
            for (double& x : column) x *= 0x1p+210;
        CHECK(count(false, 1) == 0);
    });
}

}  // namespace lostbits::test::test_unit_directions
