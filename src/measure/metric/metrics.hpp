// The metric table: a row drives the command line, the EXR layer, the CSV columns and `lostbits list metrics`.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "geometry/solid.hpp"
#include "intersect/march.hpp"
#include "measure/truth/certified.hpp"

namespace lostbits::measure::blame {
struct Blame;
}

namespace lostbits::measure::metric {

struct Metric;

/// All that is known of one ray on which form and truth agree that there is a hit; of any other ray `format`, `ray` and
/// `march` alone. Null pointers stand for values that no selected metric needs, or that do not exist (a form that
/// misses in exact arithmetic has no `self`).
struct Sample {
    double t;                       ///< the form's answer, a number of the format
    const Format* format;           ///< the format of the form under test
    const truth::Certified* truth;  ///< t*, in the unit of the form's answer (a distance for unit-direction forms)
    double truth_rounded;           ///< RN_F(t*)
    const truth::Certified* own;    ///< the truth of the inputs as the format holds them
    const truth::Certified* self;   ///< the form without rounding, on the inputs as the format holds them
    double condition;               ///< κ of the problem at its ideal inputs
    const Ray<double>* ray;         ///< the inputs as the form received them
    const Solid<double>* solid;     ///< the solid that the form hit, as it received it
    const intersect::MarchRecord* march = nullptr;  ///< null for the forms that do not march
    const blame::Blame* blame = nullptr;            ///< which operation lost the bits
    const Metric* metric = nullptr;                 ///< the one that is being measured
};

/// What must be computed before a metric can be.
enum Needs : unsigned {
    needs_nothing = 0,
    needs_rounded_truth = 1,
    needs_own_truth = 2,
    needs_self = 4,
    needs_condition = 8,
    needs_attribution = 16
};

enum class Ramp { bits, magnitude, categories };

/// The rays on which a metric is measured. `blamed` are correct hits, false hits and false misses.
enum class Over { agreed_hits, marches, blamed };

struct Metric {
    std::string_view name;     ///< on the command line and in CSV columns
    std::string_view unit;     ///< of the value
    std::string_view layer;    ///< EXR channel, `layer.channel`
    std::string_view meaning;  ///< one line with the formula
    unsigned needs;
    Ramp ramp;         ///< bits: linear from 0 to `high`; magnitude: log2|x| from `low` to `high`; categories: none
    double low, high;  ///< of the colour ramp; high = 0 stands for the format's significand width
    bool by_default;   ///< measured and written unless metrics are named
    double (*value)(const Sample&);
    Over over = Over::agreed_hits;  ///< marches: every ray, whatever its outcome, of the forms that march
    std::span<const std::string_view> categories =
        {};  ///< of a metric that names one: its value is the place in this list
    /// The list depends on the forms of the run, and is empty until it is known (`culprit_among`).
    [[nodiscard]] bool by_run() const { return over == Over::blamed; }
};

/// Every metric, in the order of layers and columns.
std::span<const Metric> metrics();

/// The row of that name, or null; of `contribution:LABEL` and `cancellation:LABEL` one that is in no table.
const Metric* find_metric(std::string_view name);

/// Lost bits of an error of that many ulps: clamp(log2(2|ulps|), 0, p). Half an ulp loses none, 2^k ulps lose k + 1.
double lost_bits(double ulps, int precision);

}  // namespace lostbits::measure::metric
