#include "intersect/device/probe.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "intersect/device/probe_program.hpp"
#include "number/real.hpp"

namespace lostbits::intersect::device {
namespace {

/// Number of inputs, each of six numbers.
constexpr std::size_t elements = 1 << 14;

template <class S>
using Six = std::array<S, 6>;

/// The inputs. The first `chosen` are fixed; the others have random significands, exponents from -16 to 16 and both
/// signs.
template <class S>
std::vector<Six<S>> numbers_to_try() {
    constexpr S least = std::numeric_limits<S>::min(), tiny = std::numeric_limits<S>::denorm_min();
    constexpr S infinity = std::numeric_limits<S>::infinity();
    std::vector<Six<S>> all{{3 * tiny, 0, 0, 1, 1, 1},
                            {3 * tiny, 1, 0, 1, 1, 1},
                            {3 * least, S(0.25), 0, 1, 1, 1},
                            {1, 0, 0, 1, 1, 1},
                            {infinity, 1, -infinity, 1, 1, 1}};
    std::uint64_t state = 1;
    const auto random = [&state] { return (state = state * 6364136223846793005U + 1442695040888963407U) >> 11; };
    while (all.size() < elements) {
        Six<S> six;
        for (S& x : six) {
            const S significand = 1 + static_cast<S>(std::ldexp(static_cast<long double>(random()), -53));
            const int exponent = static_cast<int>(random() % 33) - 16;
            x = std::ldexp(std::min(significand, std::nextafter(S(2), S(0))), exponent) *
                (random() % 2 == 0 ? S(1) : S(-1));
        }
        all.push_back(six);
    }
    return all;
}
constexpr std::size_t chosen = 5;

template <class S>
S two_sum_error(S a, S b) {
    const S s = a + b, t = s - a;
    return (a - (s - t)) + (b - t);
}

template <class S>
S kahan_sum(const Six<S>& numbers) {
    S sum = 0, c = 0;
    for (const S x : numbers) {
        const S y = x - c, t = sum + y;
        c = (t - sum) - y;
        sum = t;
    }
    return sum;
}

template <class S>
class Probing {
public:
    explicit Probing(Device& device) : given_(numbers_to_try<S>()), told_(elements) {
        const auto program = device.compile(probe_program(8 * sizeof(S), device.limits().glsl), Language::glsl);
        const std::array<Buffer, 2> buffers{
            {{std::as_writable_bytes(std::span(given_))}, {std::as_writable_bytes(std::span(told_)), true}}};
        device.run(*program, buffers, elements / group_size);
    }

    void add_to(Arithmetic& all) const {
        const auto add = [&](const char* key, std::string value) {
            all.facts.push_back({(sizeof(S) == 4 ? "f32." : "f64.") + std::string(key), std::move(value)});
        };
        using Real = long double;
        using std::abs;
        add("add", rounding(Probed::add, [](const Six<S>& n) { return Real(n[0]) + Real(n[1]); }));
        add("multiply", rounding(
                            Probed::multiply, [](const Six<S>& n) { return Real(n[0]) * Real(n[1]); },
                            [](const Six<S>& n) { return n[0] * n[1]; }));
        add("divide", rounding(
                          Probed::divide, [](const Six<S>& n) { return Real(n[0]) / Real(n[1]); },
                          [](const Six<S>& n) { return n[0] / n[1]; }));
        add("sqrt", rounding(
                        Probed::square_root, [](const Six<S>& n) { return std::sqrt(Real(abs(n[0]))); },
                        [](const Six<S>& n) { return std::sqrt(abs(n[0])); }));
        add("inversesqrt",
            rounding(Probed::inverse_root, [](const Six<S>& n) { return 1 / std::sqrt(Real(abs(n[0]))); }));
        add("length", rounding(Probed::length, [](const Six<S>& n) { return length_of(n); }));
        add("normalize", rounding(Probed::normalize, [](const Six<S>& n) { return Real(n[0]) / length_of(n); }));
        add("dot", dot_order());
        add("fma", products(Probed::fma));
        add("fma, precise", products(Probed::fma_precise));
        add("a*b+c", products(Probed::contraction));
        add("a*b+c, precise", products(Probed::contraction_precise));
        const auto two_sum = [](const Six<S>& n) { return two_sum_error(n[0], n[1]); };
        add("two_sum", survives(Probed::two_sum, two_sum));
        add("two_sum, precise", survives(Probed::two_sum_precise, two_sum));
        add("Kahan", survives(Probed::kahan, kahan_sum<S>));
        add("Kahan, precise", survives(Probed::kahan_precise, kahan_sum<S>));
        add("a*b+a*c", survives(Probed::factored, [](const Six<S>& n) { return n[0] * n[1] + n[0] * n[2]; }));
        add("sqrt(x)*sqrt(x)", survives(Probed::root_squared, [](const Six<S>& n) {
                const S root = std::sqrt(abs(n[0]));
                return root * root;
            }));
        add("subnormal given",
            told(0, Probed::add) == given_[0][0] && told(1, Probed::multiply) == given_[1][0] ? "kept" : "flushed");
        add("subnormal result", told(2, Probed::multiply) == given_[2][0] * S(0.25) ? "kept" : "flushed");
        add("1/0", std::isinf(told(3, Probed::divide)) ? "infinity" : "not infinity");
        add("inf-inf", std::isnan(told(4, Probed::contraction)) ? "NaN" : "not NaN");
    }

    void add_digest(std::uint64_t& digest) const {
        for (const std::byte byte : std::as_bytes(std::span(told_))) {
            digest ^= static_cast<std::uint64_t>(byte);
            digest *= 1099511628211U;
        }
    }

private:
    [[nodiscard]] S told(std::size_t i, Probed what) const { return told_[i][static_cast<std::size_t>(what)]; }

    static long double length_of(const Six<S>& n) {
        const auto square = [](S x) { return static_cast<long double>(x) * static_cast<long double>(x); };
        return std::sqrt(square(n[0]) + square(n[1]) + square(n[2]));
    }

    /// `correctly rounded`, or the largest error in units of the last place of the true value. `right` gives the
    /// correctly rounded value. Without it the true value, computed in long double, is rounded, which may round twice;
    /// only a sum is computed in S directly.
    [[nodiscard]] std::string rounding(Probed what, const std::function<long double(const Six<S>&)>& exact,
                                       const std::function<S(const Six<S>&)>& right = {}) const {
        std::size_t wrong = 0;
        long double worst = 0;
        for (std::size_t i = chosen; i < elements; ++i) {
            const long double truth = exact(given_[i]);
            const S rounded = right                 ? right(given_[i])
                              : what == Probed::add ? given_[i][0] + given_[i][1]
                                                    : static_cast<S>(truth);
            const S answer = told(i, what);
            wrong += answer != rounded;
            const long double ulp = std::ldexp(1.0L, std::ilogb(truth) - std::numeric_limits<S>::digits + 1);
            worst = std::max(worst, std::fabs(static_cast<long double>(answer) - truth) / ulp);
        }
        if (wrong == 0) return "correctly rounded";
        std::array<char, 80> text{};
        std::snprintf(text.data(), text.size(), "up to %.2Lf ulp; %.1f %% not correctly rounded", worst,
                      100.0 * static_cast<double>(wrong) / static_cast<double>(elements - chosen));
        return text.data();
    }

    /// Fraction of the random inputs for which the device returns what these operations give, each rounded by itself.
    [[nodiscard]] double share(Probed what, const std::function<S(const Six<S>&)>& as_written) const {
        std::size_t same = 0;
        for (std::size_t i = chosen; i < elements; ++i) same += told(i, what) == as_written(given_[i]);
        return static_cast<double>(same) / static_cast<double>(elements - chosen);
    }

    [[nodiscard]] std::string survives(Probed what, const std::function<S(const Six<S>&)>& as_written) const {
        const double same = share(what, as_written);
        if (same == 1) return "as written";
        std::array<char, 60> text{};
        std::snprintf(text.data(), text.size(), "rewritten: %.1f %% have the bits as written", 100 * same);
        return text.data();
    }

    [[nodiscard]] std::string products(Probed what) const {
        if (share(what, [](const Six<S>& n) { return std::fma(n[0], n[1], n[2]); }) == 1) return "rounds once";
        if (share(what, [](const Six<S>& n) { return n[0] * n[1] + n[2]; }) == 1) return "rounds twice";
        return "neither rounds once nor twice throughout";
    }

    [[nodiscard]] std::string dot_order() const {
        using Order = std::pair<const char*, S (*)(const Six<S>&)>;
        static constexpr std::array<Order, 6> orders{
            {{"(x+y)+z", [](const Six<S>& n) { return n[0] * n[3] + n[1] * n[4] + n[2] * n[5]; }},
             {"x+(y+z)", [](const Six<S>& n) { return n[0] * n[3] + (n[1] * n[4] + n[2] * n[5]); }},
             {"(x+z)+y", [](const Six<S>& n) { return n[0] * n[3] + n[2] * n[5] + n[1] * n[4]; }},
             {"fma(z, fma(y, x))",
              [](const Six<S>& n) { return std::fma(n[2], n[5], std::fma(n[1], n[4], n[0] * n[3])); }},
             {"fma(x, fma(y, z))",
              [](const Six<S>& n) { return std::fma(n[0], n[3], std::fma(n[1], n[4], n[2] * n[5])); }},
             {"fma(z, x+y)", [](const Six<S>& n) { return std::fma(n[2], n[5], n[0] * n[3] + n[1] * n[4]); }}}};
        for (const auto& [words, order] : orders) {
            if (share(Probed::dot, order) == 1) return words;
        }
        return "another order";
    }

    std::vector<Six<S>> given_;
    std::vector<std::array<S, probed_count>> told_;
};

/// The count that a loop to `count` reaches; if `nested`, `times` such loops in a loop.
std::uint32_t counted(Device& device, bool nested, std::uint32_t count, std::uint32_t times) {
    std::array<std::uint32_t, 3> given{count, 1, times};
    std::array<std::uint32_t, 2> told{0, 0};
    const auto program = device.compile(loop_program(device.limits().glsl, nested), Language::glsl);
    const std::array<Buffer, 2> buffers{
        {{std::as_writable_bytes(std::span(given))}, {std::as_writable_bytes(std::span(told)), true}}};
    device.run(*program, buffers, 1);
    return told[0];
}

/// Finds the number of iterations after which the device leaves a loop. The program does not count one of the 2^32
/// states of its generator, so a count that is one short is complete.
void probe_loops(Device& device, Arithmetic& all) {
    constexpr std::uint32_t tried = 1U << 20, times = 4;
    const std::uint32_t one = counted(device, false, tried, 1);
    if (one + 1 >= tried) {
        all.facts.push_back({"loops end after", "no limit up to 1048576 iterations"});
        return;
    }
    all.loop_limit = one;
    // If all loops share one budget, it runs out in the second of these.
    const std::uint32_t each = one / 8 * 5;
    all.loops_together = counted(device, true, each, times) + 1 < each * times;
    all.facts.push_back({"loops end after", std::to_string(one) + " iterations, silently" +
                                                (all.loops_together ? "; all loops of a call count together" : "")});
}

}  // namespace

const std::string_view probed_set =
    "16379 sets of six numbers with random significands, exponents from -16 to 16 and both signs; and five sets for "
    "subnormals, infinities and NaN";

std::string Arithmetic::value_of(std::string_view key) const {
    const auto found = std::ranges::find(facts, key, &Fact::key);
    return found == facts.end() ? "" : found->value;
}

Arithmetic probe(Device& device) {
    Arithmetic all;
    all.digest = 14695981039346656037U;
    const Probing<float> floats(device);
    floats.add_to(all);
    floats.add_digest(all.digest);
    if (device.limits().doubles) {
        const Probing<double> doubles(device);
        doubles.add_to(all);
        doubles.add_digest(all.digest);
    } else {
        all.facts.push_back({"f64", "none"});
    }
    probe_loops(device, all);
    all.digest = (all.digest ^ static_cast<std::uint64_t>(all.loop_limit)) * 1099511628211U;
    return all;
}

std::string line_of(const DeviceDescription& words, const Arithmetic& arithmetic) {
    std::array<char, 17> digest{};
    std::snprintf(digest.data(), digest.size(), "%016llx", static_cast<unsigned long long>(arithmetic.digest));
    return words.renderer + ", " + words.version + ", arithmetic " + digest.data();
}

}  // namespace lostbits::intersect::device
