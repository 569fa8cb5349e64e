#include "measure/truth/truth_columns.hpp"

#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

#include "measure/truth/gathered.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::truth {

using stages::RawProblems;

static_assert(static_cast<int>(Truth::Decision::miss) == 0 && static_cast<int>(Truth::Decision::hit) == 1);

namespace {

/// Truth of problem i, found without columns.
template <class S>
Truth find_single_truth(const ProblemColumns<S>& problems, const TruthOptions& options, std::size_t i) {
    const auto number_in = [i](std::span<const S> column) {
        return static_cast<double>(column[column.size() == 1 ? 0 : i]);
    };
    const auto& r = problems.ray;
    Primitive<double> primitive;
    primitive.shape = problems.shape;
    for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k)
        primitive.numbers[k] = number_in(problems.primitive[k]);
    if (problems.matrix.exists) {
        primitive.transform = Transform<double>{{}, problems.matrix.is_inverse, problems.matrix.orientation};
        for (std::size_t k = max_number_count; k < max_primitive_number_count; ++k)
            primitive.transform->matrix[k - max_number_count] = number_in(problems.primitive[k]);
    }
    return find_truth(
        {{number_in(r[0]), number_in(r[1]), number_in(r[2])}, {number_in(r[3]), number_in(r[4]), number_in(r[5])}},
        primitive, options.limit, options.convention,
        {problems.tmin.empty() ? 0 : number_in(problems.tmin),
         problems.tmax.empty() ? HUGE_VAL : number_in(problems.tmax), problems.open_ends});
}

/// Appends begin + i to `open` for each problem i that is not settled. Most problems are settled, so eight flags are
/// checked together.
void append_open(const std::uint8_t* settled, std::size_t begin, std::size_t count, std::vector<std::size_t>& open) {
    constexpr std::uint64_t all_settled = 0x0101010101010101;
    for (std::size_t first = 0; first < count; first += 8) {
        const std::size_t flag_count = std::min<std::size_t>(8, count - first);
        std::uint64_t eight_flags = all_settled;
        std::memcpy(&eight_flags, settled + first, flag_count);
        if (eight_flags == all_settled) continue;
        for (std::size_t i = first; i < first + flag_count; ++i)
            if (settled[i] == 0) open.push_back(begin + i);
    }
}

/// Finds the truth of the problems in columns, batch by batch.
template <class S>
class ColumnSearch {
public:
    ColumnSearch(const ProblemColumns<S>& problems, const TruthOptions& options, TruthColumns& out)
        : problems_(problems),
          options_(options),
          out_(out),
          stages_(stages::stages_of(problems.shape, intersect::simd::current_isa())),
          in_place_(problems) {
        const bool are_plain = !in_place_.has_ranges() && !problems.matrix.exists;
        ties_ = are_plain && problems.ray_low[0].empty() ? stages_.ties : stages::ShapeStage<double>();
    }

    void find() {
        for (std::size_t begin = 0; begin < problems_.size; begin += batch_size) {
            const std::size_t count = std::min(batch_size, problems_.size - begin);
            open_indices_.clear();

            // The stages decide by the usual convention only. Each stage settles what the ones before it left open.
            if (options_.convention.is_special()) {
                open_indices_.resize(count);
                std::iota(open_indices_.begin(), open_indices_.end(), begin);
            } else if constexpr (std::is_same_v<S, float>) {
                if (options_.tightness == Tightness::ulps_of_binary32) {
                    settle_in_place(stages_.binary64, begin, count);
                    out_.stages.binary64 += count - open_indices_.size();
                } else {
                    open_indices_.resize(count);
                    std::iota(open_indices_.begin(), open_indices_.end(), begin);
                }
                if (stages_.ties_first) settle_gathered(ties_);
                settle_gathered(stages_.double_double);
                if (!stages_.ties_first) settle_gathered(ties_);
            } else {
                settle_in_place(stages_.double_double, begin, count);
                out_.stages.double_double += count - open_indices_.size();
                settle_gathered(ties_);
            }

            for (const std::size_t i : open_indices_) settle_single(i);
        }
    }

private:
    /// Settles `count` problems from `begin` on, in their columns, and adds those that stay open to `open_indices_`.
    void settle_in_place(const stages::ShapeStage<S>& stage, std::size_t begin, std::size_t count) {
        std::uint8_t settled[batch_size];
        auto* const hits = reinterpret_cast<std::uint8_t*>(out_.decision.data());
        stages::RawFindings found{settled, hits + begin, {}, {}};
        requested_length(found) = {out_.hi.data() + begin, out_.lo.data() + begin, out_.bound.data() + begin};
        in_place_.settle(stage, stages_.lanes, begin, count, found);
        append_open(settled, begin, count, open_indices_);
    }
    /// Settles the problems in `open_indices_`. Problems that stay open remain there. Does nothing if the stage is
    /// missing.
    void settle_gathered(const stages::ShapeStage<double>& stage) {
        if (!stage || open_indices_.empty()) return;
        auto& gathered = GatheredProblems<double>::for_thread();
        const std::vector<std::size_t> indices = std::exchange(open_indices_, {});
        auto raw = gathered.gather(problems_, indices, stages_.lanes);
        raw.has_ranges = in_place_.has_ranges();
        const stages::RawLength length = requested_length(raw.out);
        raw.out.t = raw.out.distance = {};
        requested_length(raw.out) = length;
        stage(raw);

        const auto is_settled = [&](std::size_t i) {
            const auto& found = gathered.findings;
            return found.settled[i] != 0 &&
                   !(stage == ties_ &&
                     convention_matters(options_.convention, found.touches[i] != 0, found.on_surface[i] != 0));
        };
        for (std::size_t i = 0; i < indices.size(); ++i) {
            out_.decision[indices[i]] = static_cast<Truth::Decision>(gathered.findings.hit[i]);
            out_.hi[indices[i]] = length.hi[i];
            out_.lo[indices[i]] = length.lo[i];
            out_.bound[indices[i]] = length.bound[i];
        }

        for (std::size_t i = 0; i < indices.size(); ++i)
            if (!is_settled(i)) open_indices_.push_back(indices[i]);
        out_.stages.double_double += indices.size() - open_indices_.size();
    }
    [[nodiscard]] stages::RawLength& requested_length(stages::RawFindings& found) const {
        return options_.length == Length::distance ? found.distance : found.t;
    }
    void settle_single(std::size_t i) {
        const Truth truth = find_single_truth(problems_, options_, i);
        out_.decision[i] = truth.decision;
        out_.hi[i] = out_.lo[i] = out_.bound[i] = 0;
        if (truth.is_hit()) {
            const CertifiedNumber& t = options_.length == Length::parameter ? truth.t : truth.distance;
            const bool in_range = t.is_zero() || (t.exponent >= -900 && t.exponent < 900);
            const auto scale_part = [&](double x) {
                return in_range ? std::ldexp(x, static_cast<int>(t.exponent)) : missing;
            };
            out_.hi[i] = scale_part(t.hi);
            out_.lo[i] = scale_part(t.lo);
            out_.bound[i] = scale_part(t.bound);
        }
        out_.stages.count_single(truth);
        out_.single_truths.emplace_back(i, truth);
    }

    const ProblemColumns<S>& problems_;
    const TruthOptions& options_;
    TruthColumns& out_;
    stages::Stages stages_;
    ProblemsInPlace<S> in_place_;
    stages::ShapeStage<double> ties_;  ///< empty if no stage settles ties here
    std::vector<std::size_t> open_indices_;
};

template <class S>
void find_columns(const ProblemColumns<S>& problems, const TruthOptions& options, TruthColumns& out) {
    out.decision.resize(problems.size);
    for (auto* column : {&out.hi, &out.lo, &out.bound}) column->resize(problems.size);
    out.single_truths.clear();
    out.stages = {};
    ColumnSearch<S>(problems, options, out).find();
}

bool are_equal(const CertifiedNumber& a, const CertifiedNumber& b) {
    return a.hi == b.hi && a.lo == b.lo && a.bound == b.bound && a.exponent == b.exponent;
}

}  // namespace

void find_truth_columns(const ProblemColumns<float>& problems, const TruthOptions& options, TruthColumns& out) {
    find_columns(problems, options, out);
}
void find_truth_columns(const ProblemColumns<double>& problems, const TruthOptions& options, TruthColumns& out) {
    find_columns(problems, options, out);
}

void RayTruths::resize(std::size_t ray_count) {
    decision.assign(ray_count, Truth::Decision::miss);
    primitive.assign(ray_count, -1);
    touches.assign(ray_count, 0);
    on_surface.assign(ray_count, 0);
    for (auto* length : {&t, &distance})
        for (auto* column : {&length->hi, &length->lo, &length->bound}) column->assign(ray_count, 0);
}

Truth RayTruths::operator[](std::size_t i) const {
    if (std::isnan(t.hi[i]))
        return std::ranges::lower_bound(complete_truths, i, {}, &std::pair<std::size_t, Truth>::first)->second;
    Truth truth;
    truth.decision = decision[i];
    truth.primitive = primitive[i];
    truth.touches = touches[i] != 0;
    truth.on_surface = on_surface[i] != 0;
    truth.proof_bits = 106;
    if (!truth.is_hit()) return truth;
    truth.t = make_certified(t.hi[i], t.lo[i], t.bound[i]);
    truth.distance = make_certified(distance.hi[i], distance.lo[i], distance.bound[i]);
    return truth;
}

bool RayTruths::store(std::size_t i, const Truth& truth) {
    decision[i] = truth.decision;
    primitive[i] = truth.primitive;
    touches[i] = truth.touches ? 1 : 0;
    on_surface[i] = truth.on_surface ? 1 : 0;

    // Columns hold no length beyond 2^±900. NaN as the length marks a truth that they do not hold exactly.
    bool is_exact = truth.decision != Truth::Decision::unresolved;
    const auto store_length = [&](const CertifiedNumber& x, Lengths& lengths) {
        const bool in_range = truth.is_hit() && !x.is_zero() && std::abs(x.exponent) <= 900;
        const auto scaled_part = [&](double part) {
            return in_range ? std::ldexp(part, static_cast<int>(x.exponent)) : 0;
        };
        lengths.hi[i] = scaled_part(x.hi);
        lengths.lo[i] = scaled_part(x.lo);
        lengths.bound[i] = scaled_part(x.bound);
        is_exact = is_exact &&
                   (!truth.is_hit() || are_equal(make_certified(lengths.hi[i], lengths.lo[i], lengths.bound[i]), x));
    };

    store_length(truth.t, t);
    store_length(truth.distance, distance);
    if (!is_exact) t.hi[i] = missing;
    return is_exact;
}

}  // namespace lostbits::measure::truth
