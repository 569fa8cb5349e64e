// Random rays at random primitives of a shape, and the answers of a row for them. Two rows with the same operations
// give the same bits.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// The answers of a row for all rays.
template <class S>
struct FormAnswers {
    std::vector<S> t, near, far;
    std::vector<std::uint8_t> hit;

    /// True if both answers have the same bits. All misses count as the same, and so do all NaNs.
    static bool are_same(bool a_hits, S a, bool b_hits, S b) {
        if (a_hits != b_hits) return false;
        return !a_hits || (a == b && std::signbit(a) == std::signbit(b)) || (std::isnan(a) && std::isnan(b));
    }
    [[nodiscard]] bool are_same(const FormAnswers& other, std::size_t ray, bool with_t = true) const {
        return are_same(hit[ray] != 0, with_t ? t[ray] : 0, other.hit[ray] != 0, with_t ? other.t[ray] : 0);
    }
};

/// Random rays, each with a primitive of its own. They are the same on every machine.
///
/// - The coordinates of an origin are between −2048 and 2048.
/// - Rays with an even index have a random direction. Rays with an odd index are aimed near the first point of their
///   primitive.
/// - If `have_unit_directions` is true, directions have unit length. Otherwise random directions have a length below 2,
///   and aimed ones lead only a part of the way to the primitive.
template <class S>
class RandomRays {
public:
    RandomRays(Shape shape, std::size_t count, bool have_unit_directions) {
        std::mt19937_64 random(1);
        const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };  // -1 to 1
        for (std::size_t i = 0; i < count; ++i) {
            const double scale = std::ldexp(1.0, static_cast<int>(random() % 12));
            const Primitive<S> primitive = draw_primitive(shape, uniform);

            // Draws the origin and the direction. An aimed ray starts from the origin as it is stored.
            std::array<double, 3> d{};
            for (std::size_t k = 0; k < 3; ++k) {
                columns_[k].push_back(static_cast<S>(scale * uniform()));
                const auto o = static_cast<double>(columns_[k].back());
                d[k] = i % 2 == 0 ? uniform() : static_cast<double>(primitive.numbers[k]) + 0.3 * uniform() - o;
            }

            const double length = have_unit_directions ? std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
                                  : i % 2 == 0         ? 1
                                                       : 1 + scale;
            for (std::size_t k = 0; k < 3; ++k) columns_[k + 3].push_back(static_cast<S>(d[k] / length));
            primitives_.push_back(primitive);
        }
    }

    [[nodiscard]] std::size_t size() const { return primitives_.size(); }
    [[nodiscard]] std::span<const S> numbers(std::size_t ray) const { return primitives_[ray].shape_numbers(); }
    /// Input k of a tape: origin, direction, numbers of the primitive, and the end of the ray, which is infinite.
    [[nodiscard]] S input(std::size_t ray, std::size_t k) const {
        if (k < 6) return columns_[k][ray];
        return k - 6 < numbers(ray).size() ? numbers(ray)[k - 6] : std::numeric_limits<S>::infinity();
    }

    [[nodiscard]] FormAnswers<S> answers(const Kernel<S>& row) const {
        FormAnswers<S> result;
        for (auto* const column : {&result.t, &result.near, &result.far}) column->resize(size());
        result.hit.resize(size());
        row({columns_[0], columns_[1], columns_[2], columns_[3], columns_[4], columns_[5]},
            Target<S>(std::span<const Primitive<S>>(primitives_)), {result.t, result.near, result.far, result.hit});
        return result;
    }

private:
    /// Draws a primitive within the limits of its keys.
    template <class Uniform>
    static Primitive<S> draw_primitive(Shape shape, const Uniform& uniform) {
        Primitive<S> primitive(shape);
        std::size_t index = 0;
        for (const Key& key : row_of(shape).keys)
            for (std::size_t k = 0; k < key.count(); ++k, ++index) {
                double x = key.is_length() ? std::fabs(uniform()) + 0x1p-10 : 2 * uniform();
                if (key.limit == Key::Limit::at_least_previous)
                    x = static_cast<double>(primitive.numbers[index - 3]) + std::fabs(x);
                if (key.limit == Key::Limit::non_negative_below_previous)
                    x = static_cast<double>(primitive.numbers[index - 1]) * 0.5 * x;
                primitive.numbers[index] = static_cast<S>(x);
            }
        return primitive;
    }

    std::array<std::vector<S>, 6> columns_;
    std::vector<Primitive<S>> primitives_;
};

}  // namespace lostbits::intersect::table
