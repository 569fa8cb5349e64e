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

/// If more floats than this are open, they are first refined together in packs. A few are given to the full truth
/// directly, one by one.
constexpr std::size_t few = 8;

/// Adds the results of a form at the floats of a chunk to the tally of the floats before them.
class ChunkTally {
public:
    ChunkTally(UlpColumns& ulps, const scene::sweep::FloatRange& floats, FloatTally& onto, std::size_t& left)
        : ulps_(ulps), floats_(floats), onto_(onto), left_(left) {}

    void add() {
        for (std::size_t o = 0; o < ulps_.counts().size(); ++o) onto_.outcomes[o] += ulps_.counts()[o];
        add_wrong();
        add_worst();
        for (std::size_t e = 0; e < first_events.size(); ++e) {
            if (first_events[e].lost_bits > 0 && !onto_.first[e]) add_crossing(e);
        }
    }

    /// `padding(i)` is the number of u by which the slabs of float i come apart.
    template <class PaddingOf>
    void add_padding(const PaddingOf& padding) {
        if (ulps_.counts()[static_cast<std::size_t>(Outcome::false_miss)] == 0) return;
        for (std::size_t i = 0; i < ulps_.size(); ++i) {
            if (ulps_.outcome(i) != Outcome::false_miss) continue;
            const double u = padding(i);
            if (u > (onto_.padding ? onto_.padding->u : 0)) onto_.padding = {floats_.at(i), u};
        }
    }

private:
    void add_wrong() {
        const auto& counts = ulps_.counts();
        const auto any = [&](Outcome o) { return counts[static_cast<std::size_t>(o)] > 0; };
        if (!any(Outcome::false_hit) && !any(Outcome::false_miss) && !any(Outcome::not_a_number)) return;
        for (std::size_t e = 0; e < first_events.size(); ++e) {
            const Outcome o = first_events[e].outcome;
            if (first_events[e].lost_bits > 0 || !is_of_one_primitive(first_events[e]) || onto_.first[e] || !any(o))
                continue;
            std::size_t i = 0;
            while (ulps_.outcome(i) != o) ++i;
            onto_.first[e] = floats_.at(i);
        }
        std::size_t first = 0, last = ulps_.size() - 1;
        if (!onto_.first_wrong) {
            while (!answer::is_wrong(ulps_.outcome(first))) ++first;
            onto_.first_wrong = {floats_.at(first), ulps_.outcome(first)};
        }
        while (!answer::is_wrong(ulps_.outcome(last))) --last;
        onto_.last_wrong = {floats_.at(last), ulps_.outcome(last)};
    }

    /// Error above which a float counts as worse than all before it.
    [[nodiscard]] double worse_from() const {
        const double beaten = onto_.worst ? std::fabs(onto_.worst->ulps) : -1;
        return beaten < 0 ? beaten : beaten + 0x1p-20 * std::max(beaten, 1.0);
    }

    /// Floats whose error may exceed every error before them and every lower bound in the chunk.
    [[nodiscard]] std::vector<std::size_t> rivals() const {
        std::vector<std::size_t> found;
        const double floor = worse_from();
        if (!(ulps_.most_at_most() > floor)) return found;
        for (std::size_t i = 0; i < ulps_.size(); ++i) {
            if (ulps_.at_most(i) > floor && ulps_.at_most(i) >= ulps_.most_at_least()) found.push_back(i);
        }
        return found;
    }

    void take_if_worse(std::size_t i) {
        const double ulps = ulps_.exact(i);
        if (!onto_.worst || std::fabs(ulps) > std::fabs(onto_.worst->ulps)) onto_.worst = {floats_.at(i), ulps};
    }

    void add_worst() {
        const std::vector<std::size_t> some = rivals();
        if (some.size() <= few) {
            for (const std::size_t i : some) take_if_worse(i);
        } else if (some.size() <= left_) {
            left_ -= some.size();
            ulps_.refine(some);
            // Their errors are known to 2^-48 now. The first float that may have the largest error is so near to it
            // that it stands for all.
            take_if_worse(first_largest(some));
        } else if (ulps_.most_at_least() > worse_from()) {
            take_if_worse(first_largest(some));
        }
        double most = some.empty() ? std::min(ulps_.most_at_most(), worse_from()) : -1;
        for (const std::size_t i : some) most = std::max(most, ulps_.at_most(i));
        onto_.at_most = std::max(onto_.at_most, most);
    }

    [[nodiscard]] std::size_t first_largest(const std::vector<std::size_t>& some) const {
        double largest = -1;
        for (const std::size_t i : some) largest = std::max(largest, ulps_.at_least(i));
        return *std::ranges::find_if(some, [&](std::size_t i) { return ulps_.at_most(i) >= largest; });
    }

    void add_crossing(std::size_t event) {
        const double bits = first_events[event].lost_bits, crossing = std::exp2(bits - 1);
        if (ulps_.most_at_most() < crossing) return;
        std::vector<std::size_t> open;
        std::size_t sure = 0;
        for (; sure < ulps_.size() && ulps_.at_least(sure) < crossing; ++sure) {
            if (ulps_.at_most(sure) >= crossing) open.push_back(sure);
        }
        if (open.size() > few) ulps_.refine(open);
        for (const std::size_t i : open) {
            const bool crosses = ulps_.at_least(i) >= crossing ||
                                 (ulps_.at_most(i) >= crossing && std::fabs(ulps_.exact(i)) >= crossing);
            if (!crosses) continue;
            onto_.first[event] = floats_.at(i);
            return;
        }
        if (sure < ulps_.size()) onto_.first[event] = floats_.at(sure);
    }

    UlpColumns& ulps_;
    const scene::sweep::FloatRange& floats_;
    FloatTally& onto_;
    std::size_t& left_;  ///< number of floats that may still be refined in search of the worst
};

/// Box that a form tests at the floats of an axis, and the padding that its slabs need there. For a form of boxes this
/// is the primitive, for a form behind a box its bounding box; other forms have none.
class BoxOfRow {
public:
    explicit BoxOfRow(const evaluate::TestedForm& row)
        : row_(row), behind_(intersect::bounding_box::boxed_parts_of(*row.form)) {}

    [[nodiscard]] bool is_asked() const { return row_.form->shape == bounding_box_shape || behind_.form != nullptr; }
    /// Number of u by which tmax must grow for the slabs of `box.signs` to overlap at float i: the metric `padding`.
    [[nodiscard]] double padding(const AxisColumns& columns, std::size_t i) {
        if (!same_ || columns.primitive_varies()) same_ = box_around(columns.primitive(i));
        return metric::padding(columns.ray_for(row_, i), *same_);
    }

private:
    [[nodiscard]] BoundingBox<float> box_around(const Primitive<float>& primitive) const {
        if (behind_.form == nullptr) return bounding_box_of(primitive);
        const auto [lo, hi] =
            behind_.method->in(row_.format, transformed(primitive, [](float x) { return static_cast<double>(x); }));
        const auto narrow = [](const Vec<double>& v) {
            return Vec<float>(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
        };
        return {narrow(lo), narrow(hi)};
    }

    const evaluate::TestedForm& row_;
    intersect::bounding_box::BoxedFormParts behind_;
    /// The last box, which stays valid if the axis does not change the primitive.
    std::optional<BoundingBox<float>> same_;
};

/// Rows that are compared with the same truth.
struct RowsOfTruth {
    truth::ColumnTerms terms;
    std::vector<std::size_t> rows = {};
};

std::vector<RowsOfTruth> rows_by_truth(const ExhaustiveRequest& request) {
    std::vector<RowsOfTruth> groups;
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        const evaluate::TestedForm& row = request.rows[r];
        const bool unit = row.form->info->direction == intersect::Direction::unit;
        const truth::ColumnTerms terms{row.convention(), unit ? truth::Length::distance : truth::Length::parameter,
                                       truth::Tightness::ulps_of_binary32, request.limit};
        auto same = std::ranges::find_if(groups, [&](const RowsOfTruth& g) {
            return g.terms.convention == terms.convention && g.terms.length == terms.length;
        });
        if (same == groups.end()) same = groups.insert(groups.end(), {terms});
        same->rows.push_back(r);
    }
    return groups;
}

}  // namespace

std::vector<FloatTally> try_floats(const FloatsOnRay& of, truth::StageCounts& stages) {
    const auto& [request, ray, floats] = of;
    if (request.sweep.mesh) return try_floats_as_rays(of, stages);
    AxisColumns columns(request.sweep, ray, chunk_size);
    std::vector<float> values(chunk_size), t(chunk_size);
    std::vector<std::uint8_t> hit(chunk_size);
    truth::TruthColumns truths;
    const std::vector<RowsOfTruth> groups = rows_by_truth(request);
    std::vector<UlpColumns> ulps;
    for (const RowsOfTruth& group : groups) ulps.emplace_back(columns, group.terms);
    std::vector<BoxOfRow> boxes(request.rows.begin(), request.rows.end());
    std::vector<FloatTally> tallies(request.rows.size());
    std::vector<std::size_t> left(request.rows.size(), most_refined);
    for (std::uint64_t begin = 0; begin < floats.size(); begin += chunk_size) {
        const std::uint64_t n = std::min<std::uint64_t>(chunk_size, floats.size() - begin);
        const scene::sweep::FloatRange chunk{floats.at(begin), floats.at(begin + n - 1)};
        for (std::size_t i = 0; i < n; ++i) values[i] = scene::sweep::float_at(chunk.at(i));
        columns.set(std::span(values).first(n));
        for (std::size_t g = 0; g < ulps.size(); ++g) {
            request.limit.stop.check();
            find_truth_columns(columns.problems(), groups[g].terms, truths);
            stages += truths.stages;
            for (const std::size_t row : groups[g].rows) {
                columns.answer(request.rows[row], std::span(t).first(n), std::span(hit).first(n));
                ulps[g].compare(std::span(t).first(n), std::span(hit).first(n), truths);
                ChunkTally tally(ulps[g], chunk, tallies[row], left[row]);
                tally.add();
                if (boxes[row].is_asked())
                    tally.add_padding([&](std::size_t i) { return boxes[row].padding(columns, i); });
            }
        }
    }
    return tallies;
}

double padding_max(const evaluate::TestedForm& row, const FloatTally& tally) {
    if (!BoxOfRow(row).is_asked()) return truth::missing;
    return tally.padding ? tally.padding->u : 0;
}

}  // namespace lostbits::measure::sweep
