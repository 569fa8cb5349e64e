// Compares the truth of a ray in packs with Arb, MPFR, MPFI and `Ball`, on the same rays in the same run.
#include <array>
#include <cstdio>
#include <functional>
#include <random>

#include "intersect/simd/packed.hpp"
#include "measure/truth/enclose.hpp"
#include "measure/truth/truth_columns.hpp"
#include "number/real.hpp"
#include "ratios.hpp"

#if defined(LOSTBITS_HAS_ARB)
#if __has_include(<flint/arb.h>)
#include <flint/arb.h>
#else
#include <arb.h>
#endif
#endif

namespace bench {
namespace {

using namespace lostbits;
using intersect::simd::Isa;
using measure::truth::Tightness;

constexpr std::size_t ray_count = 4096;

/// Rays at one sphere as columns. Their numbers have 24 bits (binary32) or all 53 bits.
struct TruthSet {
    std::string name;
    std::vector<double> columns[6];
    std::vector<float> narrow[6];
    Sphere<double> sphere;
    double numbers[4];
    float narrow_numbers[4];

    [[nodiscard]] Ray<double> ray(std::size_t i) const {
        return {{columns[0][i], columns[1][i], columns[2][i]}, {columns[3][i], columns[4][i], columns[5][i]}};
    }
    template <class S>
    [[nodiscard]] measure::truth::ProblemColumns<S> problems() const {
        measure::truth::ProblemColumns<S> p;
        p.size = ray_count;
        for (std::size_t k = 0; k < 6; ++k) {
            if constexpr (sizeof(S) == 4) p.ray[k] = narrow[k];
            else p.ray[k] = columns[k];
        }
        for (std::size_t k = 0; k < 4; ++k) {
            if constexpr (sizeof(S) == 4) p.primitive[k] = std::span(narrow_numbers + k, 1);
            else p.primitive[k] = std::span(numbers + k, 1);
        }
        return p;
    }
};

using Draw = Ray<double> (*)(std::mt19937_64&, const Sphere<double>&);

double between(std::mt19937_64& engine, double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
}

/// A ray from a cube around the origin to a point within 1.2 radii of the sphere's centre on each axis. About half hit.
template <int distance>
Ray<double> at_sphere(std::mt19937_64& engine, const Sphere<double>& s) {
    Vec<double> origin, target;
    for (int i = 0; i < 3; ++i) {
        origin[i] = between(engine, -distance, distance) * s.radius;
        target[i] = s.centre[i] + between(engine, -1.2, 1.2) * s.radius;
    }
    return {origin, target - origin};
}
/// A ray that starts just above a huge sphere.
Ray<double> above(std::mt19937_64& engine, const Sphere<double>&) {
    const double x = between(engine, -0.5, 0.5), y = between(engine, 0.5, 1.5), z = between(engine, -0.5, 0.5);
    const double dx = between(engine, -1, 1), dy = between(engine, -0.5, 0.05), dz = between(engine, -1, 1);
    return {{x, y, z}, {dx, dy, dz}};
}

TruthSet set_of(const std::string& name, bool binary32_inputs, const Sphere<double>& sphere, Draw draw) {
    TruthSet set{.name = name + (binary32_inputs ? ", 24 bits" : ", 53 bits"),
                 .columns = {},
                 .narrow = {},
                 .sphere = sphere,
                 .numbers = {sphere.centre.x, sphere.centre.y, sphere.centre.z, sphere.radius},
                 .narrow_numbers = {}};
    for (std::size_t k = 0; k < 4; ++k) set.narrow_numbers[k] = static_cast<float>(set.numbers[k]);
    std::mt19937_64 engine(20261122);
    for (std::size_t i = 0; i < ray_count; ++i) {
        const Ray<double> ray = draw(engine, sphere);
        for (int k = 0; k < 6; ++k) {
            const double x = k < 3 ? ray.origin[k] : ray.direction[k - 3];
            set.narrow[k].push_back(static_cast<float>(x));
            set.columns[k].push_back(binary32_inputs ? static_cast<double>(set.narrow[k].back()) : x);
        }
    }
    return set;
}

/// A reference by plain high precision: the half-b quadratic in 256 bits, without a certificate.
double by_mpfr(const TruthSet& set) {
    const auto vec = [](const Vec<double>& v) { return Vec<Real>(Real(v.x), Real(v.y), Real(v.z)); };
    const Sphere<Real> sphere{vec(set.sphere.centre), Real(set.sphere.radius)};
    double sum = 0;
    for (std::size_t i = 0; i < ray_count; ++i) {
        const Ray<double> ray = set.ray(i);
        const Vec<Real> f = vec(ray.origin) - sphere.centre, d = vec(ray.direction);
        const Real a = dot(d, d), h = dot(f, d), c = dot(f, f) - sphere.radius * sphere.radius;
        const Real disc = h * h - a * c;
        if (disc < 0) continue;
        const Real root = sqrt(disc);
        Real t = (-h - root) / a;
        if (t < 0) t = (-h + root) / a;
        sum += t.convert_to<double>();
    }
    return sum;
}

double by_mpfi(const TruthSet& set) {
    const Interval::Precision precision(192);
    double sum = 0;
    for (std::size_t i = 0; i < ray_count; ++i) {
        const auto e = measure::truth::enclose<Interval>(lift_ray<Interval>(set.ray(i)),
                                                         lift_primitive<Interval>(Primitive<double>(set.sphere)));
        if (e.hit.is_yes()) sum += mpfr_get_d(e.t.lower(), MPFR_RNDN);
    }
    return sum;
}

double by_ball(const TruthSet& set) {
    double sum = 0;
    for (std::size_t i = 0; i < ray_count; ++i) sum += measure::truth::find_truth(set.ray(i), set.sphere).t.hi;
    return sum;
}

#if defined(LOSTBITS_HAS_ARB)
/// Uses Arb as its users do: the discriminant, the decision, and the near or far root, at 128 bits. The precision is
/// doubled until the ray is decided and the root is known to 72 bits.
class ByArb {
public:
    ByArb() {
        for (arb_ptr x : all_) arb_init(x);
    }
    ~ByArb() {
        for (arb_ptr x : all_) arb_clear(x);
    }
    ByArb(const ByArb&) = delete;
    ByArb& operator=(const ByArb&) = delete;

    double sum_of(const TruthSet& set) {
        double sum = 0;
        for (std::size_t i = 0; i < ray_count; ++i) {
            for (long bits = 128; bits < 20000; bits *= 2) {
                if (find(set.ray(i), set.sphere, bits)) break;
            }
            sum += hit_ ? arf_get_d(arb_midref(t_), ARF_RND_NEAR) : 0;
        }
        return sum;
    }

private:
    void dot(arb_t to, const arb_t* x, const arb_t* y, long bits) {
        arb_mul(to, x[0], y[0], bits);
        arb_addmul(to, x[1], y[1], bits);
        arb_addmul(to, x[2], y[2], bits);
    }
    bool find(const Ray<double>& ray, const Sphere<double>& sphere, long bits) {
        for (int i = 0; i < 3; ++i) {
            arb_set_d(f_[i], ray.origin[i]);
            arb_set_d(t_, sphere.centre[i]);
            arb_sub(f_[i], f_[i], t_, bits);
            arb_set_d(d_[i], ray.direction[i]);
        }
        arb_set_d(r_, sphere.radius);
        dot(h_, f_, d_, bits);
        dot(c_, f_, f_, bits);
        arb_submul(c_, r_, r_, bits);
        hit_ = false;
        if (arb_is_positive(c_) && arb_is_positive(h_)) return true;
        dot(a_, d_, d_, bits);
        arb_mul(disc_, h_, h_, bits);
        arb_submul(disc_, a_, c_, bits);
        if (arb_is_negative(disc_)) return true;
        if (!arb_is_positive(disc_) || arb_contains_zero(c_) || arb_contains_zero(h_)) return false;
        arb_sqrt(t_, disc_, bits);
        if (arb_is_positive(c_)) arb_neg(t_, t_);
        arb_sub(t_, t_, h_, bits);
        arb_div(t_, t_, a_, bits);
        hit_ = true;
        return arb_rel_accuracy_bits(t_) >= 72;
    }

    arb_t f_[3], d_[3], r_, a_, h_, c_, disc_, t_;
    std::array<arb_ptr, 12> all_{f_[0], f_[1], f_[2], d_[0], d_[1], d_[2], r_, a_, h_, c_, disc_, t_};
    bool hit_ = false;
};
#endif

struct TruthRow {
    std::string name;
    std::function<void()> pass;
};

template <class S>
TruthRow by_packs(const TruthSet& set, Isa isa, Tightness tightness, const char* name) {
    return {std::string(name) + ", " + std::string(name_of(isa)), [&set, isa, tightness] {
                static measure::truth::TruthColumns out;
                intersect::simd::set_isa(isa);
                find_truth_columns(set.problems<S>(), {.tightness = tightness}, out);
            }};
}

void print_set(const TruthSet& set, bool narrow) {
    static volatile double sink;
    std::vector<TruthRow> rows;
#if defined(LOSTBITS_HAS_ARB)
    ByArb arb;
    rows.push_back({"Arb, 128 bits and up", [&] { sink = sink + arb.sum_of(set); }});
#endif
    rows.push_back({"MPFR, 256 bits, no proof", [&] { sink = sink + by_mpfr(set); }});
    rows.push_back({"MPFI, 192 bits", [&] { sink = sink + by_mpfi(set); }});
    rows.push_back({"Ball, ray by ray", [&] { sink = sink + by_ball(set); }});
    const std::size_t ball = rows.size() - 1;
    for (const Isa isa : intersect::simd::available_isas()) {
        if (isa == Isa::scalar) continue;
        if (narrow) rows.push_back(by_packs<float>(set, isa, Tightness::ulps_of_binary32, "packs, 2^-33"));
        rows.push_back(by_packs<double>(set, isa, Tightness::certified, "packs, 2^-72"));
    }
    std::vector<measure::trade::TimedWork> work;
    for (const TruthRow& row : rows) work.push_back({row.pass, ray_count, true});
    const auto samples = measure::trade::sample_interleaved(work, {.repetitions = 9});
#if defined(LOSTBITS_HAS_ARB)
    constexpr const char* first = "over Arb";
#else
    constexpr const char* first = "over MPFR";
#endif
    std::printf("%-28s %-24s %8s %10s %10s\n", "truth", set.name.c_str(), "ns a ray", first, "over Ball");
    for (std::size_t k = 0; k < rows.size(); ++k) {
        std::printf("%-53s %8.1f", rows[k].name.c_str(), 1e9 * measure::trade::summarise_samples(samples[k]).median);
        for (const std::size_t rival : {std::size_t{0}, ball})
            std::printf(" %10.2f", measure::trade::summarise_ratios(samples[rival], samples[k]).median);
        std::printf("\n");
    }
    intersect::simd::set_isa(intersect::simd::best_isa());
    measure::truth::TruthColumns out;
    if (narrow) find_truth_columns(set.problems<float>(), {.tightness = Tightness::ulps_of_binary32}, out);
    else find_truth_columns(set.problems<double>(), {}, out);
    std::printf("  settled by binary64 %llu, double-double %llu, Ball %llu, MPFI %llu\n\n",
                static_cast<unsigned long long>(out.stages.binary64),
                static_cast<unsigned long long>(out.stages.double_double),
                static_cast<unsigned long long>(out.stages.ball), static_cast<unsigned long long>(out.stages.interval));
}

}  // namespace

void print_truth() {
    const Sphere<double> unit{{0.25, -0.5, 1.0}, 1.0};
    const auto huge = [](double r) { return Sphere<double>{{0, -r, 0}, r}; };
    for (const bool narrow : {true, false}) {
        print_set(set_of("near", narrow, unit, at_sphere<10>), narrow);
        print_set(set_of("4100 radii", narrow, unit, at_sphere<4100>), narrow);
        print_set(set_of("1e6 radii", narrow, unit, at_sphere<1'000'000>), narrow);
        print_set(set_of("above radius 6.371e6", narrow, huge(6.371e6), above), narrow);
    }
}

}  // namespace bench
