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

/// Number of inputs; each input is six numbers.
constexpr std::size_t input_count = 1 << 14;

template <class S>
using SixNumbers = std::array<S, 6>;

/// The inputs for subnormals, infinities and NaN, by what the device computes from their first numbers. They come
/// first.
enum class FixedInput : unsigned {
    subnormal_plus_zero,
    subnormal_times_one,
    subnormal_product,  ///< of a normal number and 1/4
    one_over_zero,
    infinity_minus_infinity,
    count
};
constexpr auto fixed_count = static_cast<std::size_t>(FixedInput::count);

/// Returns the inputs: the fixed ones in the order of `FixedInput`, then others with random significands, exponents
/// from -16 to 16 and both signs.
template <class S>
std::vector<SixNumbers<S>> make_probe_inputs() {
    constexpr S least = std::numeric_limits<S>::min(), tiny = std::numeric_limits<S>::denorm_min();
    constexpr S infinity = std::numeric_limits<S>::infinity();
    std::vector<SixNumbers<S>> inputs{{3 * tiny, 0, 0, 1, 1, 1},
                                      {3 * tiny, 1, 0, 1, 1, 1},
                                      {3 * least, S(0.25), 0, 1, 1, 1},
                                      {1, 0, 0, 1, 1, 1},
                                      {infinity, 1, -infinity, 1, 1, 1}};

    std::uint64_t state = 1;
    const auto random = [&state] { return (state = state * 6364136223846793005U + 1442695040888963407U) >> 11; };
    while (inputs.size() < input_count) {
        SixNumbers<S> numbers;
        for (S& x : numbers) {
            const S significand = 1 + static_cast<S>(std::ldexp(static_cast<long double>(random()), -53));
            const int exponent = static_cast<int>(random() % 33) - 16;
            x = std::ldexp(std::min(significand, std::nextafter(S(2), S(0))), exponent) *
                (random() % 2 == 0 ? S(1) : S(-1));
        }
        inputs.push_back(numbers);
    }
    return inputs;
}

template <class S>
S two_sum_error(S a, S b) {
    const S s = a + b, t = s - a;
    return (a - (s - t)) + (b - t);
}

template <class S>
S kahan_sum(const SixNumbers<S>& numbers) {
    S sum = 0, c = 0;
    for (const S x : numbers) {
        const S y = x - c, t = sum + y;
        c = (t - sum) - y;
        sum = t;
    }
    return sum;
}

template <class S>
class FormatProbe {
public:
    explicit FormatProbe(Device& device) : inputs_(make_probe_inputs<S>()), answers_(input_count) {
        const auto program = device.compile(write_probe_program(8 * sizeof(S), device.limits().glsl), Language::glsl);
        const std::array<DeviceBuffer, 2> buffers{
            {{.bytes = std::as_writable_bytes(std::span(inputs_))},
             {.bytes = std::as_writable_bytes(std::span(answers_)), .is_written = true}}};
        device.run(*program, buffers, input_count / group_size);
    }

    void add_to(Arithmetic& arithmetic) const {
        add_roundings(arithmetic);
        add_contractions(arithmetic);
        add_rewritings(arithmetic);
        add_special_values(arithmetic);
    }

    void add_digest(std::uint64_t& digest) const {
        for (const std::byte byte : std::as_bytes(std::span(answers_))) {
            digest ^= static_cast<std::uint64_t>(byte);
            digest *= 1099511628211U;
        }
    }

private:
    void add_fact(Arithmetic& arithmetic, const char* key, std::string value) const {
        arithmetic.facts.push_back({(sizeof(S) == 4 ? "f32." : "f64.") + std::string(key), std::move(value)});
    }

    /// Adds how each operation rounds, and the order in which `dot` adds.
    void add_roundings(Arithmetic& arithmetic) const {
        using Real = long double;
        using std::abs;
        const auto add = [&](const char* key, std::string value) { add_fact(arithmetic, key, std::move(value)); };

        // IEEE 754 asks that these be correctly rounded.
        add("add",
            describe_rounding(ProbedOperation::add, [](const SixNumbers<S>& n) { return Real(n[0]) + Real(n[1]); }));
        add("multiply", describe_rounding(
                            ProbedOperation::multiply, [](const SixNumbers<S>& n) { return Real(n[0]) * Real(n[1]); },
                            [](const SixNumbers<S>& n) { return n[0] * n[1]; }));
        add("divide", describe_rounding(
                          ProbedOperation::divide, [](const SixNumbers<S>& n) { return Real(n[0]) / Real(n[1]); },
                          [](const SixNumbers<S>& n) { return n[0] / n[1]; }));
        add("sqrt", describe_rounding(
                        ProbedOperation::square_root, [](const SixNumbers<S>& n) { return std::sqrt(Real(abs(n[0]))); },
                        [](const SixNumbers<S>& n) { return std::sqrt(abs(n[0])); }));

        // Functions of GLSL with an error of their own.
        add("inversesqrt", describe_rounding(ProbedOperation::inverse_root,
                                             [](const SixNumbers<S>& n) { return 1 / std::sqrt(Real(abs(n[0]))); }));
        add("length", describe_rounding(ProbedOperation::length, [](const SixNumbers<S>& n) { return length_of(n); }));
        add("normalize", describe_rounding(ProbedOperation::normalize,
                                           [](const SixNumbers<S>& n) { return Real(n[0]) / length_of(n); }));
        add("dot", find_dot_order());
    }

    /// Adds whether a product and a sum are rounded once or twice.
    void add_contractions(Arithmetic& arithmetic) const {
        add_fact(arithmetic, "fma", describe_contraction(ProbedOperation::fma));
        add_fact(arithmetic, "fma, precise", describe_contraction(ProbedOperation::fma_precise));
        add_fact(arithmetic, "a*b+c", describe_contraction(ProbedOperation::contraction));
        add_fact(arithmetic, "a*b+c, precise", describe_contraction(ProbedOperation::contraction_precise));
    }

    /// Adds whether the compiler of the device rewrites expressions by rules that rounding breaks.
    void add_rewritings(Arithmetic& arithmetic) const {
        const auto add = [&](const char* key, ProbedOperation operation, const auto& as_written) {
            add_fact(arithmetic, key, describe_rewriting(operation, as_written));
        };
        const auto two_sum = [](const SixNumbers<S>& n) { return two_sum_error(n[0], n[1]); };
        add("two_sum", ProbedOperation::two_sum, two_sum);
        add("two_sum, precise", ProbedOperation::two_sum_precise, two_sum);
        add("Kahan", ProbedOperation::kahan, kahan_sum<S>);
        add("Kahan, precise", ProbedOperation::kahan_precise, kahan_sum<S>);
        add("a*b+a*c", ProbedOperation::factored, [](const SixNumbers<S>& n) { return n[0] * n[1] + n[0] * n[2]; });
        add("sqrt(x)*sqrt(x)", ProbedOperation::root_squared, [](const SixNumbers<S>& n) {
            const S root = std::sqrt(std::abs(n[0]));
            return root * root;
        });
    }

    /// Adds the results for the fixed inputs.
    void add_special_values(Arithmetic& arithmetic) const {
        const auto add = [&](const char* key, const char* value) { add_fact(arithmetic, key, value); };
        const auto value_of = [this](FixedInput input) { return inputs_[static_cast<std::size_t>(input)][0]; };
        const bool keeps_subnormal_inputs = answer_to(FixedInput::subnormal_plus_zero, ProbedOperation::add) ==
                                                value_of(FixedInput::subnormal_plus_zero) &&
                                            answer_to(FixedInput::subnormal_times_one, ProbedOperation::multiply) ==
                                                value_of(FixedInput::subnormal_times_one);
        const bool keeps_subnormal_results = answer_to(FixedInput::subnormal_product, ProbedOperation::multiply) ==
                                             value_of(FixedInput::subnormal_product) * S(0.25);
        add("subnormal given", keeps_subnormal_inputs ? "kept" : "flushed");
        add("subnormal result", keeps_subnormal_results ? "kept" : "flushed");
        add("1/0",
            std::isinf(answer_to(FixedInput::one_over_zero, ProbedOperation::divide)) ? "infinity" : "not infinity");
        add("inf-inf", std::isnan(answer_to(FixedInput::infinity_minus_infinity, ProbedOperation::contraction))
                           ? "NaN"
                           : "not NaN");
    }

    [[nodiscard]] S answer_to(std::size_t i, ProbedOperation operation) const {
        return answers_[i][static_cast<std::size_t>(operation)];
    }
    [[nodiscard]] S answer_to(FixedInput input, ProbedOperation operation) const {
        return answer_to(static_cast<std::size_t>(input), operation);
    }

    static long double length_of(const SixNumbers<S>& n) {
        const auto square = [](S x) { return static_cast<long double>(x) * static_cast<long double>(x); };
        return std::sqrt(square(n[0]) + square(n[1]) + square(n[2]));
    }

    /// Returns `correctly rounded`, or the largest error in units of the last place of the true value.
    /// `correctly_rounded` gives the correctly rounded value. Without it the true value, computed in long double, is
    /// rounded, which may round twice; only a sum is computed in S directly.
    [[nodiscard]] std::string describe_rounding(
        ProbedOperation operation, const std::function<long double(const SixNumbers<S>&)>& exact,
        const std::function<S(const SixNumbers<S>&)>& correctly_rounded = {}) const {
        std::size_t wrong_count = 0;
        long double worst_error = 0;
        for (std::size_t i = fixed_count; i < input_count; ++i) {
            const long double true_value = exact(inputs_[i]);
            const S rounded = correctly_rounded                   ? correctly_rounded(inputs_[i])
                              : operation == ProbedOperation::add ? inputs_[i][0] + inputs_[i][1]
                                                                  : static_cast<S>(true_value);

            const S answer = answer_to(i, operation);
            wrong_count += answer != rounded;
            const long double ulp = std::ldexp(1.0L, std::ilogb(true_value) - std::numeric_limits<S>::digits + 1);
            worst_error = std::max(worst_error, std::fabs(static_cast<long double>(answer) - true_value) / ulp);
        }
        if (wrong_count == 0) return "correctly rounded";
        std::array<char, 80> text{};
        std::snprintf(text.data(), text.size(), "up to %.2Lf ulp; %.1f %% not correctly rounded", worst_error,
                      100.0 * static_cast<double>(wrong_count) / static_cast<double>(input_count - fixed_count));
        return text.data();
    }

    /// Measures the fraction of the random inputs for which the device returns the result of the operations as written,
    /// each rounded by itself.
    [[nodiscard]] double measure_fraction_as_written(ProbedOperation operation,
                                                     const std::function<S(const SixNumbers<S>&)>& as_written) const {
        std::size_t same_count = 0;
        for (std::size_t i = fixed_count; i < input_count; ++i)
            same_count += answer_to(i, operation) == as_written(inputs_[i]);
        return static_cast<double>(same_count) / static_cast<double>(input_count - fixed_count);
    }

    [[nodiscard]] std::string describe_rewriting(ProbedOperation operation,
                                                 const std::function<S(const SixNumbers<S>&)>& as_written) const {
        const double fraction = measure_fraction_as_written(operation, as_written);
        if (fraction == 1) return "as written";
        std::array<char, 60> text{};
        std::snprintf(text.data(), text.size(), "rewritten: %.1f %% have the bits as written", 100 * fraction);
        return text.data();
    }

    [[nodiscard]] std::string describe_contraction(ProbedOperation operation) const {
        if (measure_fraction_as_written(operation, [](const SixNumbers<S>& n) { return std::fma(n[0], n[1], n[2]); }) ==
            1)
            return "rounds once";
        if (measure_fraction_as_written(operation, [](const SixNumbers<S>& n) { return n[0] * n[1] + n[2]; }) == 1)
            return "rounds twice";
        return "neither rounds once nor twice throughout";
    }

    [[nodiscard]] std::string find_dot_order() const {
        using Order = std::pair<const char*, S (*)(const SixNumbers<S>&)>;
        static constexpr std::array<Order, 6> orders{
            {{"(x+y)+z", [](const SixNumbers<S>& n) { return n[0] * n[3] + n[1] * n[4] + n[2] * n[5]; }},
             {"x+(y+z)", [](const SixNumbers<S>& n) { return n[0] * n[3] + (n[1] * n[4] + n[2] * n[5]); }},
             {"(x+z)+y", [](const SixNumbers<S>& n) { return n[0] * n[3] + n[2] * n[5] + n[1] * n[4]; }},
             {"fma(z, fma(y, x))",
              [](const SixNumbers<S>& n) { return std::fma(n[2], n[5], std::fma(n[1], n[4], n[0] * n[3])); }},
             {"fma(x, fma(y, z))",
              [](const SixNumbers<S>& n) { return std::fma(n[0], n[3], std::fma(n[1], n[4], n[2] * n[5])); }},
             {"fma(z, x+y)", [](const SixNumbers<S>& n) { return std::fma(n[2], n[5], n[0] * n[3] + n[1] * n[4]); }}}};
        for (const auto& [order_name, order] : orders) {
            if (measure_fraction_as_written(ProbedOperation::dot, order) == 1) return order_name;
        }
        return "another order";
    }

    std::vector<SixNumbers<S>> inputs_;
    std::vector<std::array<S, probed_count>> answers_;
};

/// Measures the count that a loop to `count` reaches. A nested loop runs `repetitions` times inside an outer loop.
std::uint32_t measure_count(Device& device, LoopKind kind, std::uint32_t count, std::uint32_t repetitions) {
    std::array<std::uint32_t, 3> input{count, 1, repetitions};
    std::array<std::uint32_t, 2> output{0, 0};
    const auto program = device.compile(write_loop_program(device.limits().glsl, kind), Language::glsl);
    const std::array<DeviceBuffer, 2> buffers{
        {{.bytes = std::as_writable_bytes(std::span(input))},
         {.bytes = std::as_writable_bytes(std::span(output)), .is_written = true}}};
    device.run(*program, buffers, 1);
    return output[0];
}

/// Finds the number of iterations after which the device leaves a loop. The program does not count one of the 2^32
/// states of its generator, so a count that is too small by one is complete.
void probe_loops(Device& device, Arithmetic& arithmetic) {
    constexpr std::uint32_t tried_iterations = 1U << 20, repetitions = 4;
    const std::uint32_t single_limit = measure_count(device, LoopKind::single, tried_iterations, 1);
    if (single_limit + 1 >= tried_iterations) {
        arithmetic.facts.push_back({"loops end after", "no limit up to 1048576 iterations"});
        return;
    }

    // If all loops share one limit, the second of these loops reaches it.
    const std::uint32_t iterations = single_limit / 8 * 5;
    arithmetic.loop_limit = single_limit;
    arithmetic.loops_share_limit =
        measure_count(device, LoopKind::nested, iterations, repetitions) + 1 < iterations * repetitions;
    arithmetic.facts.push_back(
        {"loops end after", std::to_string(single_limit) + " iterations, silently" +
                                (arithmetic.loops_share_limit ? "; all loops of a call count together" : "")});
}

}  // namespace

const std::string_view probed_inputs =
    "16379 sets of six numbers with random significands, exponents from -16 to 16 and both signs; and five sets for "
    "subnormals, infinities and NaN";

Arithmetic probe(Device& device) {
    Arithmetic arithmetic;
    arithmetic.digest = 14695981039346656037U;
    const FormatProbe<float> floats(device);
    floats.add_to(arithmetic);
    floats.add_digest(arithmetic.digest);
    if (device.limits().has_doubles) {
        const FormatProbe<double> doubles(device);
        doubles.add_to(arithmetic);
        doubles.add_digest(arithmetic.digest);
    } else {
        arithmetic.facts.push_back({"f64", "none"});
    }
    probe_loops(device, arithmetic);
    arithmetic.digest = (arithmetic.digest ^ static_cast<std::uint64_t>(arithmetic.loop_limit)) * 1099511628211U;
    return arithmetic;
}

std::string describe_device(const DeviceDescription& description, const Arithmetic& arithmetic) {
    std::array<char, 17> digest{};
    std::snprintf(digest.data(), digest.size(), "%016llx", static_cast<unsigned long long>(arithmetic.digest));
    return description.renderer + ", " + description.version + ", arithmetic " + digest.data();
}

}  // namespace lostbits::intersect::device
