// The table of metrics. Each row defines a name on the command line, an EXR layer, CSV columns and an entry of
// `lostbits list metrics`.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "intersect/deciding_arithmetic.hpp"
#include "intersect/march.hpp"
#include "measure/answer/outcome.hpp"
#include "measure/answer/steps.hpp"
#include "measure/attribution/culprits.hpp"
#include "measure/truth/certified.hpp"
#include "measure/truth/missing.hpp"
#include "number/real.hpp"
#include "scene/rays/camera.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::metric {

/// Everything known about one ray on which form and truth agree on a hit. For any other ray, only `format`, `ray`,
/// `march`, `bounded_answer` and `deciding_arithmetic` are set. Null pointers stand for values that no selected metric
/// needs, or that do not exist (a form that misses in exact arithmetic has no `unrounded_t`).
struct Sample {
    double t = truth::missing;       ///< the form's answer, a number of the format
    const Format* format = nullptr;  ///< the format of the form under test
    /// t*, in the unit of the form's answer (a distance for unit directions).
    const truth::CertifiedNumber* true_t = nullptr;
    double rounded_truth = truth::missing;                 ///< RN_F(t*)
    const truth::CertifiedNumber* stored_truth = nullptr;  ///< the truth of the inputs as the format holds them
    /// The form without rounding, on the inputs as the format holds them.
    const truth::CertifiedNumber* unrounded_t = nullptr;
    double condition = truth::missing;  ///< κ of the problem at its ideal inputs
    double reach = truth::missing;      ///< distance that half an ulp in each input can move t*, see `truth::reach`
    double reach_normwise = truth::missing;         ///< the same for errors of u times the length of each vector
    const Ray<double>* ray = nullptr;               ///< the inputs as the form received them
    const Primitive<double>* primitive = nullptr;   ///< the primitive that the form hit, as the form received it
    const intersect::MarchRecord* march = nullptr;  ///< null for forms that do not march
    const attribution::RayAttribution* attribution = nullptr;  ///< the operation that lost the bits
    const intersect::BoundedAnswer* bounded_answer = nullptr;  ///< the answer with the form's own bound
    /// For a form that filters: the arithmetic that settled the ray.
    const intersect::DecidingArithmetic* deciding_arithmetic = nullptr;
    const answer::Steps* steps = nullptr;                   ///< for a form that transforms the ray to object space
    const answer::Levels* levels = nullptr;                 ///< for a form behind a box, where the ray truly hits
    double end_margin = truth::missing;                     ///< for a form behind a box
    const Ray<Real>* true_ray = nullptr;                    ///< the exact ray, which no format rounded or computed
    const scene::rays::CameraFrame<Real>* frame = nullptr;  ///< for a camera whose rays each format computes
    intersect::Convention convention = {};                  ///< convention of the form
    intersect::Direction direction = {};                    ///< directions that the form takes: any, or unit
    Range<double> range = {};                               ///< the part of the ray that counts
    std::array<std::string_view, 3> weights = {};  ///< the form's names of the barycentric weights on `primitive`
    answer::Outcome outcome = answer::Outcome::agree_miss;
    std::string_view label = {};  ///< label of the metric that is being measured
};

/// Inputs that must be computed before a metric.
enum Needs : unsigned {
    needs_nothing = 0,
    needs_rounded_truth = 1,
    needs_stored_truth = 2,
    needs_unrounded = 4,
    needs_condition = 8,
    needs_attribution = 16,
    needs_bound = 32,  ///< for a format that is the machine's own
    needs_deciding_arithmetic = 64,
    needs_counterfactuals = 128,
    needs_reach = 256,
    needs_reach_normwise = 512,
    needs_steps = 1024,   ///< for a form with a transform method
    needs_levels = 2048,  ///< for a form behind a box
    needs_true_ray = 4096,
    needs_end_margin = 8192,  ///< for a form behind a box
    needs_tape = needs_attribution | needs_counterfactuals
};

/// Colour ramp of a metric. lost: from 0 to `high`, on a square-root scale, so that the first bits show; kept: linear
/// from 0 to `high`; magnitude: log2|x| from `low` to `high`; categories: one colour each.
enum class Ramp { lost, kept, magnitude, categories };

/// The rays on which a metric is measured. `marches`: every ray of the forms that march, whatever its outcome. `every`:
/// every ray, whatever its outcome. `blamed`: correct hits, false hits and false misses. `pairs`: every ray of the rows
/// that are compared with another form, whatever the truth; `measure_form` itself measures them.
enum class MetricDomain { agreed_hits, marches, every, blamed, pairs };

/// The vectorised kernel of measure/columns that computes a metric for most rays. For the other rays, `value` computes
/// the same bits.
enum class ColumnKernel { none, ulp_error, lost_bits, correct_bits, relative_error, absolute_error, residual };

struct Metric {
    std::string_view name = {};     ///< name on the command line and in CSV columns
    std::string_view unit = {};     ///< unit of the value; empty if it has none
    std::string_view layer = {};    ///< EXR channel, `layer.channel`
    std::string_view meaning = {};  ///< one line with the formula
    unsigned needs = needs_nothing;
    Ramp ramp = Ramp::lost;
    /// Ends of the colour ramp. 0 stands for a default that depends on the precision p of the format: `high` is p, or
    /// 2^p for a magnitude; `low` of a magnitude is 2^-(p + 6).
    double low = 0, high = 0;
    bool is_default = false;                   ///< measured and written unless metrics are named
    double (*value)(const Sample&) = nullptr;  ///< value on one ray; NaN if it does not exist
    MetricDomain domain = MetricDomain::agreed_hits;
    /// Categories of a metric whose value names one: the value is an index into this list.
    std::span<const std::string_view> categories = {};
    bool depends_on_forms = false;  ///< the categories depend on the forms of the run: empty until
                                    ///< `MetricSet::adapt_to_forms` knows the forms
    ColumnKernel column_kernel = ColumnKernel::none;
    std::string_view label = {};  ///< `c` of `contribution:c`; empty for the metrics of the table
};

/// Name, unit and layer of a row of the table.
struct MetricNames {
    std::string_view name, unit, layer;
};
/// Builds a row of the table; `rest` gives the members that are not parameters.
constexpr Metric table_row(MetricNames names, std::string_view meaning, double (*value)(const Sample&),
                           Metric rest = {}) {
    rest.name = names.name;
    rest.unit = names.unit;
    rest.layer = names.layer;
    rest.meaning = meaning;
    rest.value = value;
    return rest;
}

/// Every metric that needs no label, in the order of layers and columns.
std::span<const Metric> metrics();

/// Finds the row of that name; null for an unknown name.
const Metric* find_metric(std::string_view name);

/// Index of the metric of that name in a list; the list's size if the list does not have it.
std::size_t index_of(const std::vector<const Metric*>& metrics, std::string_view name);

}  // namespace lostbits::measure::metric
