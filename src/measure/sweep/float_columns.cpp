#include "measure/sweep/float_columns.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "intersect/simd/packed_many.hpp"
#include "measure/truth/lost_bits.hpp"
#include "measure/truth/unit_direction.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;
using evaluate::TestedForm;
using intersect::Direction;
using intersect::table::HitBatch;
using intersect::table::RayBatch;

namespace {

Vec<float> unit_direction_in_binary32(const Vec<float>& direction) {
    const Vec<double> d = truth::unit_direction(Vec<double>(direction.x, direction.y, direction.z), binary32);
    return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
}

std::span<const float> single_number(const float& x) { return {&x, 1}; }

}  // namespace

AxisColumns::AxisColumns(const scene::sweep::ExhaustiveFile& file, std::size_t ray, std::size_t capacity)
    : file_(file), ray_(ray), near_(capacity), far_(capacity) {
    const Ray<float>& r = file.rays[ray].ray;
    ray_numbers_ = {r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z};
    primitive_numbers_ = file.primitive.numbers;
    for (const std::size_t index : file.ray_indices) ray_varies_[index] = true;
    for (const std::size_t index : file.primitive_indices) primitive_varies_[index] = true;
    direction_varies_ = ray_varies_[3] || ray_varies_[4] || ray_varies_[5];
    for (std::size_t k = 0; k < ray_columns_.size(); ++k)
        if (!ray_varies_[k]) ray_columns_[k].assign(capacity, ray_numbers_[k]);
    for (std::size_t k = 0; k < primitive_columns_.size() && !file.primitive_indices.empty(); ++k)
        if (!primitive_varies_[k]) primitive_columns_[k].assign(capacity, primitive_numbers_[k]);
    if (std::isfinite(file.rays[ray].tmax)) tmax_.assign(capacity, file.rays[ray].tmax);
}

void AxisColumns::set_values(std::span<const float> values) {
    values_ = values;
    if (direction_varies_) has_unit_directions_ = false;
    has_primitives_ = false;
}

truth::ProblemColumns<float> AxisColumns::problems() const { return problems(values_); }

truth::ProblemColumns<float> AxisColumns::problems(std::span<const float> values) const {
    truth::ProblemColumns<float> columns{
        .size = values.size(), .ray = {}, .shape = file_.primitive.shape, .primitive = {}};
    for (std::size_t k = 0; k < 6; ++k) columns.ray[k] = ray_varies_[k] ? values : single_number(ray_numbers_[k]);
    for (std::size_t k = 0; k < file_.primitive.shape_numbers().size(); ++k)
        columns.primitive[k] = primitive_varies_[k] ? values : single_number(primitive_numbers_[k]);
    if (!tmax_.empty()) columns.tmax = single_number(tmax_.front());
    return columns;
}

truth::Truth AxisColumns::find_truth(std::size_t i, const truth::TruthOptions& options) const {
    const scene::rays::RayGroup group = file_.group_at(ray_, values_[i]);
    return truth::find_truth(group.rays[0], group.primitives[0], options.limit, options.convention,
                             group.rays.range(0));
}

/// Computes the directions for forms of unit directions, in the same way as maps do.
void AxisColumns::make_unit_directions() {
    if (has_unit_directions_) return;
    has_unit_directions_ = true;
    const std::size_t capacity = near_.size(), count = direction_varies_ ? values_.size() : capacity;
    for (auto& column : unit_columns_) column.resize(capacity);
    Vec<float> d{};
    for (std::size_t i = 0; i < count; ++i) {
        if (i == 0 || direction_varies_)
            d = unit_direction_in_binary32(file_.ray_at(ray_, direction_varies_ ? values_[i] : 0.0F).direction);
        for (int k = 0; k < 3; ++k) unit_columns_[k][i] = d[k];
    }
}

/// Builds the primitives once for all forms. There are many forms, and building the primitives takes nearly as long as
/// running one of them.
void AxisColumns::make_primitives() {
    if (has_primitives_) return;
    has_primitives_ = true;
    primitives_.resize(values_.size(), file_.primitive);
    for (std::size_t i = 0; i < values_.size(); ++i)
        for (const std::size_t index : file_.primitive_indices) primitives_[i].numbers[index] = values_[i];
}

std::span<const float> AxisColumns::ray_column(std::size_t component, bool is_unit) const {
    if (is_unit && component >= 3) return std::span<const float>(unit_columns_[component - 3]).first(values_.size());
    return ray_varies_[component] ? values_ : std::span<const float>(ray_columns_[component]).first(values_.size());
}

Ray<float> AxisColumns::ray_for(const TestedForm& tested_form, std::size_t i) const {
    Ray<float> ray = file_.ray_at(ray_, values_[i]);
    if (tested_form.form->info->direction == Direction::unit)
        ray.direction = {unit_columns_[0][i], unit_columns_[1][i], unit_columns_[2][i]};
    return ray;
}

void AxisColumns::answer(const TestedForm& tested_form, std::span<float> t, std::span<std::uint8_t> hit) {
    const bool is_unit = tested_form.form->info->direction == Direction::unit;
    if (is_unit) make_unit_directions();
    const std::size_t n = values_.size();
    const std::span<const float> tmax = tmax_.empty() ? tmax_ : std::span<const float>(tmax_).first(n);
    const RayBatch<float> batch{.ox = ray_column(0, is_unit),
                                .oy = ray_column(1, is_unit),
                                .oz = ray_column(2, is_unit),
                                .dx = ray_column(3, is_unit),
                                .dy = ray_column(4, is_unit),
                                .dz = ray_column(5, is_unit),
                                .tmax = tmax};
    const HitBatch<float> hits{t, std::span(near_).first(n), std::span(far_).first(n), hit};
    if (file_.primitive_indices.empty())
        intersect::simd::packed_kernels(*tested_form.form).f32(batch, intersect::Target<float>(file_.primitive), hits);
    else answer_primitives(tested_form, batch, hits);
}

/// Runs the packed kernel for one ray against many primitives if there is one; its answers have the same bits. A kernel
/// that takes tmax is not used, because it cannot tell a miss from a hit at tmax.
void AxisColumns::answer_primitives(const TestedForm& tested_form, const RayBatch<float>& rays,
                                    const HitBatch<float>& hits) {
    const std::size_t n = values_.size();
    const intersect::simd::ManyFormKernels kernels = intersect::simd::many_kernels(*tested_form.form);
    if (!kernels.f32 || kernels.takes_tmax || !file_.ray_indices.empty()) {
        make_primitives();
        return tested_form.form->native32(
            rays, intersect::Target<float>(std::span<const Primitive<float>>(primitives_)), hits);
    }
    intersect::simd::PrimitiveArrays<float> primitives;
    for (std::size_t k = 0; k < file_.primitive.shape_numbers().size(); ++k)
        primitives.numbers[k] = primitive_varies_[k] ? values_ : std::span<const float>(primitive_columns_[k]).first(n);
    kernels.f32(ray_for(tested_form, 0), primitives, hits.t, hits.hit);
}

namespace {

/// 1/ulp(t*) in binary32 for t* = hi + lo ≥ 0, whose binade is proved: 2^(23 − max(⌊log2 t*⌋, −126)). If hi is a
/// power of two and lo < 0, t* lies below hi, and so does the double before hi. Uses only operations that SIMD
/// registers of every width support.
double inverse_ulp(double hi, double lo) {
    constexpr double smallest_normal = 0x1p-126;
    const auto below = std::bit_cast<double>(std::bit_cast<std::uint64_t>(hi) - (lo < 0 ? 1U : 0U));
    const double in_binade = below > smallest_normal ? below : smallest_normal;
    constexpr std::uint64_t exponent_bits = 0x7ff0000000000000U, exponent_sum = std::uint64_t{2 * 1023 + 23} << 52;
    return std::bit_cast<double>(exponent_sum - (std::bit_cast<std::uint64_t>(in_binade) & exponent_bits));
}

struct ErrorRange {
    double low, high;
};

/// Bounds of |t − t*|/ulp(t*), given |t* − (hi + lo)| ≤ bound. The subtractions of hi and of lo are rounded, each with
/// a relative error of at most 2^-53; if they cancel, t − hi is exact. The factors 1 ± 2^-50 cover both roundings and
/// that of the product with the bound.
ErrorRange error_bounds(float t, double hi, double lo, double bound) {
    const double scale = inverse_ulp(hi, lo);
    const double error = std::fabs((static_cast<double>(t) - hi) - lo) * scale;
    const double margin = bound * scale;
    return {error * (1 - 0x1p-50) - margin * (1 + 0x1p-50), (error + margin) * (1 + 0x1p-50)};
}

/// Largest element, or −1 if all are smaller. Eight partial maxima fit into registers.
double largest_element(const std::vector<double>& numbers) {
    constexpr std::size_t part_count = 8;
    std::array<double, part_count> maxima{};
    maxima.fill(-1);
    std::size_t i = 0;
    for (; i + part_count <= numbers.size(); i += part_count) {
        for (std::size_t k = 0; k < part_count; ++k)
            maxima[k] = numbers[i + k] > maxima[k] ? numbers[i + k] : maxima[k];
    }
    for (; i < numbers.size(); ++i) maxima[0] = std::max(maxima[0], numbers[i]);
    return std::ranges::max(maxima);
}

}  // namespace

/// Writes the outcomes into `outcome_` and counts them. The floats of a chunk mostly have the same outcome.
void UlpColumns::classify(std::span<const std::uint8_t> hit, const truth::TruthColumns& truth) {
    static const answer::OutcomeTable table;
    const auto outcome_of = [](std::uint8_t case_index) { return static_cast<std::uint8_t>(table[case_index]); };
    const std::size_t n = t_.size();
    // The pointers are local, because the compiler must assume that a store of bytes changes the vectors themselves. It
    // would then handle one float at a time.
    const auto* const decision = truth.decision.data();
    const std::uint8_t* const hits = hit.data();
    const float* const t = t_.data();
    std::uint8_t* const case_index = outcome_.data();
    static_assert(sizeof *decision == 1);
    for (std::size_t i = 0; i < n; ++i)
        case_index[i] = static_cast<std::uint8_t>(4 * static_cast<unsigned>(decision[i]) + 2U * (hits[i] != 0));
    for (std::size_t i = 0; i < n; ++i)
        case_index[i] = static_cast<std::uint8_t>(case_index[i] + (t[i] != t[i] ? 1 : 0));
    counts_ = {};
    if (std::memcmp(outcome_.data(), outcome_.data() + 1, n - 1) == 0) {
        counts_[outcome_of(outcome_[0])] = n;
        std::ranges::fill(outcome_, outcome_of(outcome_[0]));
        return;
    }
    for (std::size_t i = 0; i < n; ++i) {
        outcome_[i] = outcome_of(outcome_[i]);
        ++counts_[outcome_[i]];
    }
}

void UlpColumns::compare(std::span<const float> t, std::span<const std::uint8_t> hit,
                         const truth::TruthColumns& truth) {
    const std::size_t n = t.size();
    t_ = t;
    outcome_.resize(n);
    low_.resize(n);
    high_.resize(n);
    classify(hit, truth);

    largest_low_ = largest_high_ = -1;
    if (counts_[static_cast<std::size_t>(Outcome::agree_hit)] == 0) {
        std::ranges::fill(low_, -1.0);
        std::ranges::fill(high_, -1.0);
        return;
    }

    // Bounds the errors of all floats in one loop without branches, then drops those that are not both hits.
    constexpr auto both_hit = static_cast<std::uint8_t>(Outcome::agree_hit);
    const double *const hi = truth.hi.data(), *const lo = truth.lo.data(), *const bound = truth.bound.data();
    const float* const answer = t.data();
    double *const low = low_.data(), *const high = high_.data();
    for (std::size_t i = 0; i < n; ++i) {
        const ErrorRange bounds = error_bounds(answer[i], hi[i], lo[i], bound[i]);
        low[i] = bounds.low;
        high[i] = bounds.high;
    }
    if (counts_[both_hit] < n) {
        for (std::size_t i = 0; i < n; ++i) {
            if (outcome_[i] != both_hit) low[i] = high[i] = -1;
        }
    }

    // Columns cannot hold a length beyond 2^±900.
    for (const auto& [i, complete_truth] : truth.single_truths) {
        if (outcome_[i] != both_hit || !std::isnan(truth.hi[i])) continue;
        const auto& length = options_.length == truth::Length::parameter ? complete_truth.t : complete_truth.distance;
        set_exact_error(i, truth::ulp_error(static_cast<double>(t[i]), length, binary32));
    }

    largest_low_ = largest_element(low_);
    largest_high_ = largest_element(high_);
}

void UlpColumns::set_exact_error(std::size_t i, double ulps) { low_[i] = high_[i] = std::fabs(ulps); }

void UlpColumns::refine(std::span<const std::size_t> indices) {
    std::vector<float> values(indices.size());
    std::ranges::transform(indices, values.begin(), [&](std::size_t i) { return columns_.values()[i]; });
    truth::TruthOptions options = options_;
    options.tightness = truth::Tightness::certified;
    find_truth_columns(columns_.problems(values), options, refined_truths_);
    for (std::size_t k = 0; k < indices.size(); ++k) {
        const std::size_t i = indices[k];
        if (std::isnan(refined_truths_.hi[k]) || std::isinf(t_[i])) continue;
        const ErrorRange bounds =
            error_bounds(t_[i], refined_truths_.hi[k], refined_truths_.lo[k], refined_truths_.bound[k]);
        low_[i] = bounds.low;
        high_[i] = bounds.high;
    }
}

double UlpColumns::find_exact_error(std::size_t i) {
    const truth::Truth truth = columns_.find_truth(i, options_);
    const auto& length = options_.length == truth::Length::parameter ? truth.t : truth.distance;
    const double ulps = truth::ulp_error(static_cast<double>(t_[i]), length, binary32);
    set_exact_error(i, ulps);
    return ulps;
}

}  // namespace lostbits::measure::sweep
