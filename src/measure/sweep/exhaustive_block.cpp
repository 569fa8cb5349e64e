#include "measure/sweep/exhaustive.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "intersect/bounding_box/behind.hpp"
#include "measure/metric/values.hpp"
#include "measure/sweep/float_columns.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;

namespace {

constexpr std::size_t chunk_size = 4096;  // the columns of a chunk stay in the second-level cache

/// Largest number of undecided floats that are given to the complete truth one by one. If there are more, they are
/// first refined together in packs.
constexpr std::size_t max_single_floats = 8;

/// Adds the results of a form at the floats of a chunk to the tally of the floats before the chunk.
class ChunkTally {
public:
    ChunkTally(UlpColumns& ulps, const scene::sweep::FloatRange& floats, FloatTally& tally,
               std::size_t& refinements_left)
        : ulps_(ulps), floats_(floats), tally_(tally), refinements_left_(refinements_left) {}

    void add() {
        for (std::size_t o = 0; o < ulps_.counts().size(); ++o) tally_.outcomes[o] += ulps_.counts()[o];
        add_wrong();
        add_worst();
        for (std::size_t e = 0; e < first_events.size(); ++e) {
            if (first_events[e].lost_bits > 0 && !tally_.first_floats[e]) add_threshold_crossing(e);
        }
    }

    /// Adds the largest padding among the missed hits. `padding(i)` is the gap between the slabs at float i, in u.
    template <class PaddingOf>
    void add_padding(const PaddingOf& padding) {
        if (ulps_.counts()[static_cast<std::size_t>(Outcome::false_miss)] == 0) return;
        for (std::size_t i = 0; i < ulps_.size(); ++i) {
            if (ulps_.outcome(i) != Outcome::false_miss) continue;
            const double u = padding(i);
            if (u > (tally_.padding ? tally_.padding->u : 0)) tally_.padding = {floats_.at(i), u};
        }
    }

private:
    void add_wrong() {
        const auto& counts = ulps_.counts();
        const auto occurs = [&](Outcome o) { return counts[static_cast<std::size_t>(o)] > 0; };
        if (!occurs(Outcome::false_hit) && !occurs(Outcome::false_miss) && !occurs(Outcome::not_a_number)) return;

        // The first float of each wrong decision.
        for (std::size_t e = 0; e < first_events.size(); ++e) {
            const Outcome o = first_events[e].outcome;
            if (first_events[e].lost_bits > 0 || !is_of_one_primitive(first_events[e]) || tally_.first_floats[e] ||
                !occurs(o))
                continue;
            std::size_t i = 0;
            while (ulps_.outcome(i) != o) ++i;
            tally_.first_floats[e] = floats_.at(i);
        }

        // The first and the last wrong float.
        std::size_t first = 0, last = ulps_.size() - 1;
        if (!tally_.first_wrong) {
            while (!answer::is_wrong(ulps_.outcome(first))) ++first;
            tally_.first_wrong = {floats_.at(first), ulps_.outcome(first)};
        }
        while (!answer::is_wrong(ulps_.outcome(last))) --last;
        tally_.last_wrong = {floats_.at(last), ulps_.outcome(last)};
    }

    /// Error above which a float counts as worse than all before it.
    [[nodiscard]] double worse_threshold() const {
        const double largest_so_far = tally_.worst ? std::fabs(tally_.worst->ulps) : -1;
        return largest_so_far < 0 ? largest_so_far : largest_so_far + 0x1p-20 * std::max(largest_so_far, 1.0);
    }

    /// Floats whose error may exceed all errors before the chunk and every lower bound in the chunk.
    [[nodiscard]] std::vector<std::size_t> worst_candidates() const {
        std::vector<std::size_t> candidates;
        const double threshold = worse_threshold();
        if (!(ulps_.largest_upper_bound() > threshold)) return candidates;
        for (std::size_t i = 0; i < ulps_.size(); ++i) {
            if (ulps_.upper_bound(i) > threshold && ulps_.upper_bound(i) >= ulps_.largest_lower_bound())
                candidates.push_back(i);
        }
        return candidates;
    }

    void replace_worst_if_worse(std::size_t i) {
        const double ulps = ulps_.find_exact_error(i);
        if (!tally_.worst || std::fabs(ulps) > std::fabs(tally_.worst->ulps)) tally_.worst = {floats_.at(i), ulps};
    }

    /// Finds the worst float of the chunk, and bounds the errors of all others.
    void add_worst() {
        const std::vector<std::size_t> candidates = worst_candidates();
        if (candidates.size() <= max_single_floats) {
            for (const std::size_t i : candidates) replace_worst_if_worse(i);
        } else if (candidates.size() <= refinements_left_) {
            refinements_left_ -= candidates.size();
            ulps_.refine(candidates);
            // Their errors are known to 2^-48 now. The first float that may have the largest error is so near to that
            // error that it stands for all of them.
            replace_worst_if_worse(first_largest(candidates));
        } else if (ulps_.largest_lower_bound() > worse_threshold()) {
            replace_worst_if_worse(first_largest(candidates));
        }

        double bound = candidates.empty() ? std::min(ulps_.largest_upper_bound(), worse_threshold()) : -1;
        for (const std::size_t i : candidates) bound = std::max(bound, ulps_.upper_bound(i));
        tally_.error_bound = std::max(tally_.error_bound, bound);
    }

    /// First of the candidates that may have the largest error.
    [[nodiscard]] std::size_t first_largest(const std::vector<std::size_t>& candidates) const {
        double largest = -1;
        for (const std::size_t i : candidates) largest = std::max(largest, ulps_.lower_bound(i));
        return *std::ranges::find_if(candidates, [&](std::size_t i) { return ulps_.upper_bound(i) >= largest; });
    }

    /// Finds the first float whose error reaches the number of bits of an event.
    void add_threshold_crossing(std::size_t event) {
        const double bits = first_events[event].lost_bits, threshold = std::exp2(bits - 1);
        if (ulps_.largest_upper_bound() < threshold) return;

        // Floats before the first one that certainly crosses the threshold may cross it.
        std::vector<std::size_t> undecided;
        std::size_t first_certain = 0;
        for (; first_certain < ulps_.size() && ulps_.lower_bound(first_certain) < threshold; ++first_certain) {
            if (ulps_.upper_bound(first_certain) >= threshold) undecided.push_back(first_certain);
        }
        if (undecided.size() > max_single_floats) ulps_.refine(undecided);

        for (const std::size_t i : undecided) {
            const bool crosses =
                ulps_.lower_bound(i) >= threshold ||
                (ulps_.upper_bound(i) >= threshold && std::fabs(ulps_.find_exact_error(i)) >= threshold);
            if (!crosses) continue;
            tally_.first_floats[event] = floats_.at(i);
            return;
        }
        if (first_certain < ulps_.size()) tally_.first_floats[event] = floats_.at(first_certain);
    }

    UlpColumns& ulps_;
    const scene::sweep::FloatRange& floats_;
    FloatTally& tally_;
    std::size_t& refinements_left_;  ///< number of floats that may still be refined in search of the worst
};

/// Box that a form tests at the floats of an axis, and the padding that its slabs need there. A form of the shape box
/// tests the primitive. A form with a bounding box in front tests the bounding box of the primitive. Other forms test
/// no box.
class TestedBox {
public:
    explicit TestedBox(const evaluate::TestedForm& tested_form)
        : row_(tested_form), boxed_parts_(intersect::bounding_box::find_boxed_parts(*tested_form.form)) {}

    [[nodiscard]] bool has_box() const {
        return row_.form->shape == bounding_box_shape || boxed_parts_.form != nullptr;
    }
    /// Number of u by which tmax must grow for the slabs of `box.signs` to overlap at float i: the metric `padding`.
    [[nodiscard]] double padding(const AxisColumns& columns, std::size_t i) {
        if (!last_box_ || columns.primitive_varies()) last_box_ = box_around(columns.primitive(i));
        return metric::padding(columns.ray_for(row_, i), *last_box_);
    }

private:
    [[nodiscard]] BoundingBox<float> box_around(const Primitive<float>& primitive) const {
        if (boxed_parts_.form == nullptr) return bounding_box_of(primitive);
        const auto [lo, hi] = boxed_parts_.method->compute_box(
            row_.format, convert_numbers(primitive, [](float x) { return static_cast<double>(x); }));
        const auto narrow = [](const Vec<double>& v) {
            return Vec<float>(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
        };
        return {narrow(lo), narrow(hi)};
    }

    const evaluate::TestedForm& row_;
    intersect::bounding_box::BoxedFormParts boxed_parts_;
    /// The last box, which stays valid if the axis does not change the primitive.
    std::optional<BoundingBox<float>> last_box_;
};

/// Rows that are compared with the same truth.
struct FormsWithTruth {
    truth::TruthOptions options;
    std::vector<std::size_t> rows = {};
};

std::vector<FormsWithTruth> group_rows_by_truth(const ExhaustiveRequest& request) {
    std::vector<FormsWithTruth> groups;
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        const evaluate::TestedForm& tested_form = request.tested_forms[r];
        const bool takes_unit_directions = tested_form.form->info->direction == intersect::Direction::unit;
        const truth::TruthOptions options{tested_form.convention(),
                                          takes_unit_directions ? truth::Length::distance : truth::Length::parameter,
                                          truth::Tightness::ulps_of_binary32, request.limit};
        auto group = std::ranges::find_if(groups, [&](const FormsWithTruth& g) {
            return g.options.convention == options.convention && g.options.length == options.length;
        });
        if (group == groups.end()) group = groups.insert(groups.end(), {options});
        group->rows.push_back(r);
    }
    return groups;
}

/// Runs the rows of a request on one ray, chunk by chunk, and keeps the columns of a chunk for the next one.
class ChunkRunner {
public:
    ChunkRunner(const ExhaustiveRequest& request, std::size_t ray)
        : request_(request),
          columns_(request.sweep, ray, chunk_size),
          values_(chunk_size),
          form_t_(chunk_size),
          form_hit_(chunk_size),
          groups_(group_rows_by_truth(request)),
          boxes_(request.tested_forms.begin(), request.tested_forms.end()),
          tallies_(request.tested_forms.size()),
          refinements_left_(request.tested_forms.size(), max_refined_floats) {
        for (const FormsWithTruth& group : groups_) ulps_.emplace_back(columns_, group.options);
    }

    /// Adds the floats of the next chunk to the tallies. The truth is found once for all rows that share it.
    void run(const scene::sweep::FloatRange& chunk, truth::StageCounts& stages) {
        const std::size_t count = chunk.size();
        for (std::size_t i = 0; i < count; ++i) values_[i] = scene::sweep::float_at(chunk.at(i));
        columns_.set_values(std::span(values_).first(count));

        for (std::size_t g = 0; g < groups_.size(); ++g) {
            request_.limit.stop.check();
            find_truth_columns(columns_.problems(), groups_[g].options, truths_);
            stages += truths_.stages;
            for (const std::size_t form_index : groups_[g].rows) add_answers(form_index, ulps_[g], chunk);
        }
    }
    std::vector<FloatTally> take_tallies() { return std::move(tallies_); }

private:
    /// Runs a row on the floats of a chunk, compares it with `truths_`, and adds the results to its tally.
    void add_answers(std::size_t form_index, UlpColumns& ulps, const scene::sweep::FloatRange& chunk) {
        const std::span<float> t = std::span(form_t_).first(chunk.size());
        const std::span<std::uint8_t> hit = std::span(form_hit_).first(chunk.size());
        columns_.answer(request_.tested_forms[form_index], t, hit);
        ulps.compare(t, hit, truths_);

        ChunkTally tally(ulps, chunk, tallies_[form_index], refinements_left_[form_index]);
        tally.add();
        if (boxes_[form_index].has_box())
            tally.add_padding([&](std::size_t i) { return boxes_[form_index].padding(columns_, i); });
    }

    const ExhaustiveRequest& request_;
    AxisColumns columns_;
    std::vector<float> values_, form_t_;
    std::vector<std::uint8_t> form_hit_;
    truth::TruthColumns truths_;
    std::vector<FormsWithTruth> groups_;
    std::vector<UlpColumns> ulps_;  ///< for each group
    std::vector<TestedBox> boxes_;
    std::vector<FloatTally> tallies_;
    std::vector<std::size_t> refinements_left_;
};

}  // namespace

std::vector<FloatTally> try_floats(const FloatsOnRay& floats_on_ray, truth::StageCounts& stages) {
    const auto& [request, ray, floats] = floats_on_ray;
    if (request.sweep.mesh) return try_floats_as_rays(floats_on_ray, stages);
    ChunkRunner runner(request, ray);
    for (std::uint64_t begin = 0; begin < floats.size(); begin += chunk_size) {
        const std::uint64_t count = std::min<std::uint64_t>(chunk_size, floats.size() - begin);
        runner.run({floats.at(begin), floats.at(begin + count - 1)}, stages);
    }
    return runner.take_tallies();
}

double max_padding(const evaluate::TestedForm& tested_form, const FloatTally& tally) {
    if (!TestedBox(tested_form).has_box()) return truth::missing;
    return tally.padding ? tally.padding->u : 0;
}

}  // namespace lostbits::measure::sweep
