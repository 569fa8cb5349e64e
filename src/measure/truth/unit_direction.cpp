#include "measure/truth/unit_direction.hpp"

#include <algorithm>
#include <cmath>

#include "measure/stages/stages.hpp"
#include "measure/truth/certified.hpp"
#include "measure/truth/missing.hpp"
#include "number/real.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::measure::truth {
namespace {

/// Component of the unit direction at one precision; empty if the enclosure straddles a rounding boundary.
template <class E>
std::optional<double> component(double coordinate, const E& length, const FloatFormat& format) {
    if (coordinate == 0) return coordinate;
    const auto x = certify(E(coordinate) / length);
    return x ? round_certified(*x, format) : std::nullopt;
}

template <class E>
E length_of(const Vec<double>& d) {
    return length(Vec<E>(E(d.x), E(d.y), E(d.z)));
}

double exact_component(double coordinate, const Vec<double>& d, const FloatFormat& format) {
    std::optional<CertifiedNumber> last;
    for (int bits = 192; bits <= 8192; bits *= 2) {
        const Interval::Precision precision(bits);
        const Interval length = length_of<Interval>(d);
        if (const auto x = component(coordinate, length, format)) return *x;
        last = certify(Interval(coordinate) / length);
    }
    if (!last) return missing;
    // A component may be exactly halfway (3/5 of a power of two, say, in a tiny format). The midpoint is then rounded
    // to even.
    last->bound = 0;
    return round_certified(*last, format).value_or(missing);
}

}  // namespace

Vec<double> unit_direction(const Vec<double>& d, const FloatFormat& format) {
    const Ball length = length_of<Ball>(d);
    const auto unit_component = [&](double x) {
        const auto from_ball = component(x, length, format);
        return from_ball ? *from_ball : exact_component(x, d, format);
    };
    return Vec<double>(unit_component(d.x), unit_component(d.y), unit_component(d.z));
}

void make_unit(const std::array<std::span<double>, 3>& directions, const FloatFormat& format) {
    constexpr std::size_t block_size = 512;
    double buffers[3][block_size];
    std::uint8_t settled[block_size];
    const stages::Stages stages = stages::stages_of(shape_rows.front().shape, intersect::simd::current_isa());
    const bool is_native = format == binary32 || format == binary64;

    for (std::size_t begin = 0; begin < directions[0].size(); begin += block_size) {
        const std::size_t count = std::min(block_size, directions[0].size() - begin);
        const std::size_t whole_count = is_native ? count - count % stages.lanes : 0;
        double* const coordinates[3] = {directions[0].data() + begin, directions[1].data() + begin,
                                        directions[2].data() + begin};

        // The stage settles whole packs of native formats; it leaves out what it cannot prove.
        if (whole_count > 0)
            stages.unit_directions({{coordinates[0], coordinates[1], coordinates[2]},
                                    {buffers[0], buffers[1], buffers[2]},
                                    settled,
                                    format == binary32,
                                    1,
                                    whole_count});

        for (std::size_t i = 0; i < count; ++i) {
            if (i < whole_count && settled[i] != 0) {
                for (int k = 0; k < 3; ++k) coordinates[k][i] = buffers[k][i];
            } else {
                const Vec<double> u = unit_direction({coordinates[0][i], coordinates[1][i], coordinates[2][i]}, format);
                for (int k = 0; k < 3; ++k) coordinates[k][i] = u[k];
            }
        }
    }
}

double as_distance(double t, const Vec<double>& d, const FloatFormat& format) {
    if (t == 0 || !std::isfinite(t)) return t;
    return scene::toml::round_to_format(Real(t) * length(Vec<Real>(Real(d.x), Real(d.y), Real(d.z))), format);
}

}  // namespace lostbits::measure::truth
