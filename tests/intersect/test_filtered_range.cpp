// The promise of `box.filtered` and `sphere.filtered` over every finite number: exponents drawn over the whole range of
// the format, each on its own, and rays built to touch, shifted by powers of two to where products over- and underflow.
// Judged in exact integers (tests/measure/truth/exact_reference.hpp), which share no code with the forms.
//
//   LOSTBITS_RAYS=100000000 build/test_filtered "[long-range]"      as many rays of each form and format
#include <tbb/parallel_for.h>

#include <atomic>
#include <bit>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <sstream>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/hostile_rays.hpp"
#include "measure/truth/exact_reference.hpp"
#include "number/pack.hpp"
#include "number/wide/wide_pack.hpp"
#include "shapes/box/forms/filtered.hpp"
#include "shapes/sphere/forms/filtered.hpp"

namespace lostbits::test {
namespace {

using testing::Dyadic;

/// Any finite number of S: its bits are drawn.
template <class S>
S any_number(Random& random) {
    using Bits = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
    for (;;) {
        const auto x = std::bit_cast<S>(static_cast<Bits>(random.bits()));
        if (std::isfinite(x)) return x;
    }
}

template <class S>
constexpr int lowest = std::numeric_limits<S>::min_exponent - std::numeric_limits<S>::digits;
template <class S>
constexpr int highest = std::numeric_limits<S>::max_exponent;

template <class S>
double shifted(double x, int k) {
    return static_cast<double>(static_cast<S>(std::ldexp(x, k)));
}

/// Draws rays whose numbers go over all exponents of S.
template <class S>
class WideRays {
public:
    explicit WideRays(std::uint64_t seed) : random_(seed), hostile_(seed ^ 0x5555) {}

    HostileRay box() {
        HostileRay x;
        if (random_.one_in(3)) {
            x = hostile_.box(any(box_families.size()));
            Box<double> box = x.solid.box();
            move(x.ray, {&box.lo, &box.hi}, nullptr);
            x.solid = box;
            if (random_.one_in(3)) x.tmax = std::fabs(number());
            return x;
        }
        Box<double> box;
        const int base = exponent(), spread = random_.one_in(2) ? 4 : 2000;
        for (int k = 0; k < 3; ++k) {
            box.lo[k] = length(base, spread);
            box.hi[k] = random_.one_in(8) ? box.lo[k] : length(base, spread);
            if (box.lo[k] > box.hi[k]) std::swap(box.lo[k], box.hi[k]);
            const long at = random_.between(0, 5);
            x.ray.origin[k] = at == 0 ? box.lo[k] : at == 1 ? box.hi[k] : at == 2 ? 0 : length(base, spread);
        }
        x.ray.direction = direction();
        x.solid = box;
        x.tmax = random_.one_in(2) ? HUGE_VAL : random_.one_in(9) ? std::numeric_limits<S>::max() : std::fabs(number());
        return x;
    }

    HostileRay sphere() {
        HostileRay x;
        if (random_.one_in(2)) {
            x = hostile_.sphere(any(sphere_families.size()));
            Sphere<double> sphere = x.solid.sphere();
            move(x.ray, {&sphere.centre, nullptr}, &sphere.radius);
            x.solid = sphere;
            return x;
        }
        Sphere<double> sphere;
        const int base = exponent(), spread = random_.one_in(2) ? 4 : 2000;
        for (int k = 0; k < 3; ++k) {
            sphere.centre[k] = random_.one_in(4) ? 0 : length(base, spread);
            x.ray.origin[k] = random_.one_in(8) ? sphere.centre[k] : length(base, spread);
        }
        do sphere.radius = std::fabs(length(base, spread));
        while (sphere.radius == 0);
        x.ray.direction = direction();
        x.solid = sphere;
        return x;
    }

private:
    std::size_t any(std::size_t n) { return static_cast<std::size_t>(random_.between(0, static_cast<long>(n) - 1)); }
    int exponent() { return static_cast<int>(random_.between(lowest<S>, highest<S>)); }
    double number() { return static_cast<double>(any_number<S>(random_)); }
    /// A number within `spread` binades of 2^base, whole numbers of the last places among them.
    double length(int base, int spread) {
        if (spread > 1000) return random_.one_in(10) ? 0 : number();
        const double m = random_.one_in(3) ? static_cast<double>(random_.between(-8, 8)) : 2 * random_.unit() - 1;
        const double x = shifted<S>(m, base + static_cast<int>(random_.between(-spread, spread)));
        return std::isfinite(x) ? x : number();
    }
    Vec<double> direction() {
        Vec<double> d(0, 0, 0);
        const int base = exponent(), spread = random_.one_in(2) ? 4 : 2000;
        do
            for (int k = 0; k < 3; ++k) d[k] = random_.one_in(5) ? random_.sign() * 0.0 : length(base, spread);
        while (d.x == 0 && d.y == 0 && d.z == 0);
        return d;
    }
    /// All lengths by one power of two and the direction by another; as it was where that overflows or leaves zeros.
    void move(Ray<double>& ray, std::array<Vec<double>*, 2> points, double* radius) {
        const int by = exponent(), along = exponent();
        Ray<double> r = ray;
        std::array<Vec<double>, 2> p{*points[0], points[1] ? *points[1] : Vec<double>(0, 0, 0)};
        double size = radius ? shifted<S>(*radius, by) : 1, sum = 0;
        for (int k = 0; k < 3; ++k) {
            r.origin[k] = shifted<S>(r.origin[k], by);
            r.direction[k] = shifted<S>(r.direction[k], along);
            for (auto& point : p) point[k] = shifted<S>(point[k], by), sum += std::fabs(point[k]) * 0;
            sum += 0 * (r.origin[k] + r.direction[k]);
        }
        if (sum != 0 || !std::isfinite(size) || size == 0) return;
        if (r.direction.x == 0 && r.direction.y == 0 && r.direction.z == 0) return;
        ray = r;
        *points[0] = p[0];
        if (points[1]) *points[1] = p[1];
        if (radius) *radius = size;
    }

    Random random_;
    HostileRays<S> hostile_;
};

/// The t of a box, the larger of the entries and zero: its sides are those of fractions.
class ExactBoxHit {
public:
    ExactBoxHit(const Ray<double>& ray, const Box<double>& box, double tmax) {
        const auto below = [](const Dyadic& n, const Dyadic& m, const Dyadic& f, const Dyadic& g) {
            return compare(n * g, f * m) <= 0;
        };
        std::vector<std::pair<Dyadic, Dyadic>> exits;
        entries_.emplace_back(Dyadic(0.0), Dyadic(1.0));
        if (std::isfinite(tmax)) exits.emplace_back(Dyadic(tmax), Dyadic(1.0));
        for (int k = 0; k < 3; ++k) {
            const double d = ray.direction[k];
            const Dyadic o(ray.origin[k]), lo = Dyadic(box.lo[k]) - o, hi = Dyadic(box.hi[k]) - o;
            if (d == 0) {
                hit_ = hit_ && lo.sign() <= 0 && hi.sign() >= 0;
            } else {
                entries_.emplace_back(d > 0 ? lo : -hi, Dyadic(std::fabs(d)));
                exits.emplace_back(d > 0 ? hi : -lo, Dyadic(std::fabs(d)));
            }
        }
        for (const auto& [n, m] : entries_)
            for (const auto& [f, g] : exits) hit_ = hit_ && below(n, m, f, g);
    }
    [[nodiscard]] bool hit() const { return hit_; }
    /// The sign of t* − x.
    [[nodiscard]] int side(const Dyadic& x) const {
        int most = -1;
        for (const auto& [n, m] : entries_) most = std::max(most, compare(n, x * m));
        return most;
    }

private:
    std::vector<std::pair<Dyadic, Dyadic>> entries_;
    bool hit_ = true;
};

/// Whether t is within 32 u of itself of t*, or within the distance of subnormal numbers, or beyond the largest number.
template <class S, class Exact>
bool keeps_its_bits(S t, const Exact& exact) {
    using Limits = std::numeric_limits<S>;
    if (!(t >= 0)) return false;
    const Dyadic at(static_cast<double>(std::min(t, Limits::max())));
    const Dyadic slack = at.scaled(5 - Limits::digits) + Dyadic(static_cast<double>(Limits::denorm_min()));
    return exact.side(at - slack) >= 0 && (std::isinf(t) || exact.side(at + slack) <= 0);
}

constexpr auto ask_sphere = [](const auto& x) {
    using T = std::decay_t<decltype(x(0))>;
    return intersect::sphere::Filtered::intersect(Ray<T>{{x(0), x(1), x(2)}, {x(3), x(4), x(5)}},
                                                  Sphere<T>{{x(6), x(7), x(8)}, x(9)});
};
constexpr auto ask_box = [](const auto& x) {
    using T = std::decay_t<decltype(x(0))>;
    return intersect::box::FilteredSlabs::intersect(Ray<T>{{x(0), x(1), x(2)}, {x(3), x(4), x(5)}},
                                                    Box<T>{{x(6), x(7), x(8)}, {x(9), x(10), x(11)}}, x(12));
};

struct Tally {
    std::atomic<std::uint64_t> rays{0}, hits{0}, wrong{0}, lost{0}, differ{0};
    std::mutex guard;
    std::string first;

    void note(const HostileRay& x) {
        const std::lock_guard lock(guard);
        if (!first.empty()) return;
        std::ostringstream text;
        text << std::hexfloat;
        for (int k = 0; k < 3; ++k) text << x.ray.origin[k] << ' ' << x.ray.direction[k] << ' ';
        for (const double number : x.solid.numbers) text << number << ' ';
        text << x.tmax;
        first = text.str();
    }
};

template <class S, class Exact>
void judge_one(Tally& all, const HostileRay& x, const Hit<S>& found, const Exact& exact) {
    ++all.rays;
    all.hits += exact.hit();
    const bool wrong = found.hit != exact.hit(), lost = !wrong && exact.hit() && !keeps_its_bits(found.t, exact);
    all.wrong += wrong;
    all.lost += lost;
    if (wrong || lost) all.note(x);
}

/// `rays` of S, four packs of two to four lanes at a time, which must answer as the scalar form does.
template <class S>
void judge(Tally& all, Shape shape, std::uint64_t rays, std::uint64_t seed) {
    using P = Pack<S, Registers<16>>;
    constexpr std::uint64_t group = 4096;
    tbb::parallel_for(std::uint64_t{0}, (rays + group - 1) / group, [&](std::uint64_t g) {
        WideRays<S> draw(seed << 32 | g);
        std::array<std::array<S, P::lanes>, 13> columns;
        for (std::uint64_t i = 0; i < group / P::lanes; ++i) {
            std::array<Hit<S>, P::lanes> single;
            for (std::size_t lane = 0; lane < P::lanes; ++lane) {
                const HostileRay x = shape == Shape::sphere ? draw.sphere() : draw.box();
                for (int k = 0; k < 3; ++k) {
                    columns[static_cast<std::size_t>(k)][lane] = static_cast<S>(x.ray.origin[k]);
                    columns[static_cast<std::size_t>(3 + k)][lane] = static_cast<S>(x.ray.direction[k]);
                }
                for (std::size_t k = 0; k < 6; ++k) columns[6 + k][lane] = static_cast<S>(x.solid.numbers[k]);
                columns[12][lane] = static_cast<S>(x.tmax);
                const auto one = [&](int c) { return columns[static_cast<std::size_t>(c)][lane]; };
                if (shape == Shape::sphere) {
                    single[lane] = ask_sphere(one);
                    judge_one(all, x, single[lane], testing::ExactHit(x.ray, x.solid.sphere()));
                } else {
                    single[lane] = ask_box(one);
                    judge_one(all, x, single[lane], ExactBoxHit(x.ray, x.solid.box(), x.tmax));
                }
            }
            const auto many = [&](int c) { return P::load(columns[static_cast<std::size_t>(c)].data()); };
            const Hit<P> packed = shape == Shape::sphere ? ask_sphere(many) : ask_box(many);
            S t[P::lanes];
            bool hit[P::lanes];
            packed.t.store(t);
            packed.hit.store(hit);
            for (std::size_t lane = 0; lane < P::lanes; ++lane) {
                const S a = t[lane], b = single[lane].t;
                all.differ += hit[lane] != single[lane].hit || !(a == b || (a != a && b != b));
            }
        }
    });
}

template <class S>
void check_range(Shape shape, std::uint64_t rays, std::uint64_t seed) {
    Tally all;
    judge<S>(all, shape, rays, seed);
    INFO((shape == Shape::sphere ? "spheres" : "boxes")
         << " in " << 8 * sizeof(S) << " bits: " << all.rays << " rays, " << all.hits << " hits, " << all.wrong
         << " wrong, " << all.lost << " below their bits; first " << all.first);
    CHECK(all.wrong == 0);
    CHECK(all.lost == 0);
    CHECK(all.differ == 0);
    CHECK(all.hits > all.rays / 50);
}

}  // namespace

TEMPLATE_TEST_CASE("filtered boxes decide right and keep their bits over all exponents", "[intersect][filtered][range]",
                   float, double) {
    check_range<TestType>(Shape::box, draws(200 * 4096), 11);
}

TEMPLATE_TEST_CASE("filtered spheres decide right and keep their bits over all exponents",
                   "[intersect][filtered][range]", float, double) {
    check_range<TestType>(Shape::sphere, draws(200 * 4096), 17);
}

TEST_CASE("the promise over all exponents and as many rays as asked for", "[.][long-range]") {
    const char* const asked = std::getenv("LOSTBITS_RAYS");
    const char* const seed_asked = std::getenv("LOSTBITS_SEED");
    const std::uint64_t rays = asked ? std::strtoull(asked, nullptr, 10) : 10000000;
    const std::uint64_t seed = seed_asked ? std::strtoull(seed_asked, nullptr, 10) : 13;
    for (const Shape shape : {Shape::sphere, Shape::box}) {
        check_range<float>(shape, rays, seed);
        check_range<double>(shape, rays, seed);
    }
}

}  // namespace lostbits::test
