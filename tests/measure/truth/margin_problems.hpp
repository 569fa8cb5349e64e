// Problems of every shape on which margins are attacked, and the attack: a search for the least change that turns the
// decision, by exact decisions alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "measure/seeded.hpp"
#include "measure/truth/truth.hpp"
#include "shapes/lift.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::test {

struct MarginProblem {
    Ray<double> ray;
    Primitive<double> primitive;

    [[nodiscard]] bool is_proper() const {
        return measure::truth::is_valid(ray) && measure::truth::is_valid(primitive);
    }
    /// True if the ray hits; empty if the problem is not valid.
    [[nodiscard]] std::optional<bool> hits() const {
        if (!is_proper()) return std::nullopt;
        return measure::truth::find_truth(ray, primitive).is_hit();
    }
    [[nodiscard]] std::vector<double> numbers() const {
        std::vector<double> x;
        for (const Vec<double>& v : {ray.origin, ray.direction})
            for (int i = 0; i < 3; ++i) x.push_back(v[i]);
        x.insert(x.end(), primitive.shape_numbers().begin(), primitive.shape_numbers().end());
        return x;
    }
    [[nodiscard]] MarginProblem with(const std::vector<double>& x) const {
        MarginProblem to{{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}}, primitive};
        std::copy(x.begin() + 6, x.end(), to.primitive.shape_numbers().begin());
        return to;
    }
};

/// Rays at random; towards a silhouette, a rim or an edge, as near as 2^-3 to 2^-30 of the way, from near and from
/// thousands of radii away; across the axis; through the middle; from inside; along axes with small whole numbers,
/// where much is exactly 0.
class MarginProblems {
public:
    static constexpr int kinds = 8;

    MarginProblems(Shape shape, Seeded& rng) : shape_(shape), rng_(rng) {}

    std::optional<MarginProblem> draw(int kind) {
        MarginProblem p{{}, primitive(kind == whole)};
        if (!measure::truth::is_valid(p.primitive)) return std::nullopt;
        Sphere<double> ball = ball_around(p.primitive);
        if (shape_ == Shape::plane) ball.radius = 2;
        if (kind == whole) p.ray = whole_ray(ball.centre);
        else if (kind == across || kind == across_near) p.ray = across_ray(p.primitive, ball);
        else {
            const double away =
                kind == inside ? rng_.uniform(0, 0.5) : std::exp2(rng_.uniform(0.1, kind == far ? 12 : 4));
            const Vec<double> from = ball.centre + (ball.radius * away) * way();
            p.ray = {from, (kind == middle ? ball.centre : about(ball)) - from};
        }
        if (kind == near || kind == far || kind == across_near) {
            const auto to = grazing(p, ball);
            if (!to) return std::nullopt;
            p.ray.direction = *to;
        }
        p.ray = {stored(p.ray.origin, binary32), stored(p.ray.direction, binary32)};
        return p.is_proper() ? std::optional(p) : std::nullopt;
    }

private:
    enum : int { anywhere, near, across, middle, inside, whole, across_near, far };

    Vec<double> way() {
        for (;;) {
            const Vec<double> v = rng_.vec(-1, 1);
            const double size = length(v);
            if (size > 0.1 && size < 1) return (1 / size) * v;
        }
    }
    Vec<double> about(const Sphere<double>& ball) { return ball.centre + (ball.radius * rng_.uniform(0, 1.3)) * way(); }

    Primitive<double> primitive(bool of_whole_numbers) {
        const auto one = [&] { return static_cast<double>(rng_.integer(-2, 2)); };
        const Vec<double> near_0 = rng_.vec(-3, 3), whole_numbers{one(), one(), one()};
        const double half = std::exp2(rng_.uniform(-2, 2));
        if (of_whole_numbers) return primitive_around<double>(shape_, whole_numbers, 1);
        Primitive<double> made = primitive_around<double>(shape_, near_0, half);
        for_each_key(shape_, [&](const Key& key, std::size_t at) {
            for (std::size_t i = at; i < at + key.count(); ++i) {
                double& x = made.numbers[i];
                if (key.kind == Key::Kind::length) x *= rng_.uniform(0.6, 1.4);
                else x += (key.kind == Key::Kind::direction ? 1 : half) * rng_.uniform(-1, 1);
            }
        });
        for (double& x : made.shape_numbers()) x = stored(x, binary32);
        return made;
    }
    Ray<double> whole_ray(const Vec<double>& centre) {
        Vec<double> d{0, 0, 0}, off{0, 0, 0};
        while (square(d) == 0)
            for (int i = 0; i < 3; ++i) d[i] = static_cast<double>(rng_.integer(-1, 1));
        for (int i = 0; i < 3; ++i) off[i] = static_cast<double>(rng_.integer(-8, 8)) / 4;
        return {centre + off + -4.0 * d, d};
    }
    /// v·d is 0, or the rounding error of 0.
    Ray<double> across_ray(const Primitive<double>& of, const Sphere<double>& ball) {
        Vec<double> axis{0, 0, 1};
        std::vector<Vec<double>> points;
        for_each_key(shape_, [&](const Key& key, std::size_t at) {
            if (key.count() != 3) return;
            if (key.kind == Key::Kind::direction) axis = of.point(at);
            else points.push_back(of.point(at));
        });
        if (points.size() > 1) axis = points[1] - points[0];
        const Vec<double> d = cross(axis, way()), along = (1 / length(d)) * d;
        return {about(ball) - (ball.radius * rng_.uniform(1.5, 6)) * along, along};
    }
    /// Halves the way between a ray that hits and one that misses a few times.
    std::optional<Vec<double>> grazing(const MarginProblem& p, const Sphere<double>& ball) {
        Vec<double> a = p.ray.origin + (4 * ball.radius / length(p.ray.direction)) * p.ray.direction, b = about(ball);
        const auto hits = [&](const Vec<double>& to) {
            return MarginProblem{{p.ray.origin, to - p.ray.origin}, p.primitive}.hits();
        };
        const auto at_a = hits(a), at_b = hits(b);
        if (!at_a || !at_b || *at_a == *at_b) return std::nullopt;
        for (int i = rng_.index(28) + 3; i > 0; --i) {
            const Vec<double> half = 0.5 * (a + b);
            (hits(half) == at_a ? a : b) = half;
        }
        return (rng_.coin() ? a : b) - p.ray.origin;
    }

    Shape shape_;
    Seeded& rng_;
};

/// The least change that the attack finds, of each number x by at most that times |x|; infinite where it finds none
/// below `most`. From random signs of the changes it goes to the size at which they turn the decision, then sets one
/// sign after the other to what makes that size smaller.
class Attack {
public:
    Attack(const MarginProblem& problem, Seeded& rng)
        : problem_(problem), rng_(rng), x_(problem.numbers()), hits_(problem.hits().value()) {}

    double least(double most, int starts) {
        double best = most;
        std::vector<double> way(x_.size()), best_way;
        for (int start = 0; start < starts; ++start) {
            for (double& w : way) w = rng_.sign();
            if (!best_way.empty() && rng_.coin()) {
                way = best_way;
                for (int i = 0; i < 3; ++i) way[index()] *= -1;
            }
            double size = best;
            while (size > best * 0x1p-20 && !turns(way, size)) size /= 4;
            if (size <= best * 0x1p-20) continue;
            size = climb(way, shrunk(way, size));
            if (size < best) best = size, best_way = way;
        }
        return best < most ? best : HUGE_VAL;
    }

private:
    std::size_t index() { return static_cast<std::size_t>(rng_.index(static_cast<int>(x_.size()))); }
    [[nodiscard]] bool turns(const std::vector<double>& way, double size) const {
        std::vector<double> y = x_;
        for (std::size_t i = 0; i < y.size(); ++i) y[i] += std::nextafter(way[i] * size * std::fabs(x_[i]), 0.0);
        for (std::size_t i = 0; i < y.size(); ++i)
            if (std::fabs(y[i] - x_[i]) > size * std::fabs(x_[i])) y[i] = std::nextafter(y[i], x_[i]);
        const auto hits = problem_.with(y).hits();
        return hits && *hits != hits_;
    }
    [[nodiscard]] double shrunk(const std::vector<double>& way, double high) const {
        double low = 0;
        for (int i = 0; i < 60 && low == 0; ++i) turns(way, high / 2) ? high /= 2 : low = high / 2;
        for (int i = 0; i < 6; ++i) (turns(way, (low + high) / 2) ? high : low) = (low + high) / 2;
        return high;
    }
    [[nodiscard]] double climb(std::vector<double>& way, double size) const {
        for (bool better = true; better;) {
            better = false;
            for (std::size_t i = 0; i < way.size(); ++i) {
                if (x_[i] == 0) continue;
                for (const double other : {-way[i], 0.0}) {
                    std::vector<double> tried = way;
                    tried[i] = other;
                    if (other == way[i] || !turns(tried, size * 0.98)) continue;
                    way = tried, size = shrunk(way, size * 0.98), better = true;
                    break;
                }
            }
        }
        return size;
    }

    const MarginProblem& problem_;
    Seeded& rng_;
    std::vector<double> x_;
    bool hits_;
};

}  // namespace lostbits::test
