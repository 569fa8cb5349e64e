#include "measure/sweep/worst.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "intersect/process/parallel.hpp"
#include "measure/evaluate/measure_form.hpp"
#include "measure/truth/missing.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"
#include "scene/rays/random.hpp"
#include "scene/sweep/distributions.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;
using intersect::Direction;

namespace {

constexpr int batch_size = 32;  // candidates that are measured together

/// Number of the format that comes `steps` numbers after x.
double move_by_steps(double x, std::int64_t steps, const FloatFormat& format) {
    return truth::number_at(truth::ordinal(x, format) + steps, format);
}

/// Ray and primitive as one list of numbers, in the order of the ranges of the search.
struct SearchPoint {
    std::array<double, 6 + max_number_count> numbers{};
    [[nodiscard]] Ray<double> ray() const {
        return {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
    }
    [[nodiscard]] Primitive<double> primitive(Shape shape) const {
        Primitive<double> s;
        s.shape = shape;
        for (std::size_t i = 0; i < s.shape_numbers().size(); ++i) s.numbers[i] = numbers[6 + i];
        return s;
    }
};

/// Worst candidate of a batch.
class BatchWorst {
public:
    BatchWorst(std::size_t metric, Direction direction, const scene::sweep::SearchFile& file)
        : metric_(metric), direction_(direction), file_(file) {}
    void add(const evaluate::BandResult& result) {
        for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
            const Outcome ray_outcome = result.outcomes[i];
            if (ray_outcome == Outcome::agree_miss || ray_outcome == Outcome::unresolved) continue;
            if (file_.hits_only && ray_outcome != Outcome::agree_hit) continue;
            const double magnitude = std::fabs(result.metrics[metric_][i]);
            const double value = ray_outcome == Outcome::agree_hit
                                     ? (file_.is_minimised ? 1 / magnitude : magnitude)
                                     : score_of_wrong_decision(result.inputs->rays[i], result.inputs->primitives[0]);
            if (!(value > score)) continue;
            score = value;
            index = i;
            outcome = ray_outcome;
            t = result.answers->t[i];
            truth = result.truth(i).is_hit() ? result.band->rounded_truth(i, binary64, direction_, result.convention)
                                             : truth::missing;
        }
    }
    double score = -1;
    std::size_t index = 0;
    Outcome outcome = Outcome::agree_miss;
    double t = 0, truth = 0;

private:
    /// Score of a wrong decision, which is above the score of every right decision.
    [[nodiscard]] double score_of_wrong_decision(const Ray<double>& ray, const Primitive<double>& primitive) const {
        return file_.nearest ? 0x1p1000 / std::max(1.0, scene::sweep::distance_in_radii(ray, primitive))
                             : std::numeric_limits<double>::infinity();
    }

    std::size_t metric_;
    Direction direction_;
    const scene::sweep::SearchFile& file_;
};

class WorstSearch {
public:
    WorstSearch(const WorstRequest& request, const evaluate::TestedForm& tested_form)
        : request_(request),
          file_(request.search),
          row_(tested_form),
          random_(file_.seed),
          metric_(metric::index_of(request.metrics, file_.metric)) {}

    std::optional<WorstResult> run() {
        for (int start = 0; start < file_.start_count && !is_over(); ++start) climb();
        best_.evaluation_count = evaluations_;
        return best_score_ < 0 ? std::nullopt : std::optional(best_);
    }

private:
    [[nodiscard]] bool is_over() const { return best_.outcome != Outcome::agree_hit && !file_.nearest; }

    /// Improves one random candidate by small random changes, generation by generation.
    void climb() {
        const auto start = draw_candidate();
        if (!start) return;
        SearchPoint current = *start;
        double score = -1;
        for (int g = 0; g < file_.generation_count; ++g) {
            // All candidates of a batch have one primitive, so that their rays share a band.
            const SearchPoint parent =
                g == 0 ? current : draw_neighbour(current, 6, file_.ranges.size(), random_.below(2));
            std::vector<SearchPoint> candidates{parent};
            while (candidates.size() < batch_size)
                candidates.push_back(draw_neighbour(parent, 0, 6, 1 + random_.below(3)));
            const BatchWorst batch_worst = measure_batch(candidates);
            if (batch_worst.score < score) continue;
            score = batch_worst.score;
            current = candidates[batch_worst.index];
            store_if_worse(batch_worst, current);
            if (is_over()) return;
        }
    }

    /// Draws a random candidate within the ranges of the search, with a ray that is aimed at the primitive; empty if
    /// 4096 tries find none.
    std::optional<SearchPoint> draw_candidate() {
        for (int attempt = 0; attempt < 4096; ++attempt) {
            SearchPoint p;
            for (std::size_t i = 0; i < file_.ranges.size(); ++i) {
                const auto [low, high] = file_.ranges[i];
                p.numbers[i] = file_.exponents ? random_number() : low + random_.unit() * (high - low);
            }
            if (file_.nearest) move_primitive_nearer(p);
            if (file_.at_edge) put_edge_on_ray(p);
            else if (file_.aim) aim_at_feature(p);
            else aim_at_point(p);
            for (double& x : p.numbers) x = rounding::to_format(x, 0, row_.format.parameters);
            if (file_.contains(p.ray(), p.primitive(file_.shape))) return p;
        }
        return std::nullopt;
    }

    /// Random number in [1, 2): uniform, or at a distance from 1 or 2 whose exponent is uniform.
    double random_significand() {
        const double m = 1 + random_.unit(),
                     sparse = std::ldexp(1 + random_.unit(), -2 - random_.below(row_.format.parameters.precision - 1));
        const double choices[] = {m, 1 + sparse, 2 - sparse};
        return choices[random_.below(3)];
    }
    double random_number() {
        const auto [low, high] = *file_.exponents;
        const int e = static_cast<int>(low) + random_.below(static_cast<int>(high - low) + 1);
        return random_.sign() * std::ldexp(random_significand(), e);
    }

    /// Puts an edge of the box on the ray: the edge between the plane through which the ray enters the slab of one axis
    /// and the plane through which it leaves the slab of another. Rounding moves the planes, and the origin is moved to
    /// make up for that. The smaller the origin is, the nearer the ray comes to the edge.
    void put_edge_on_ray(SearchPoint& point) {
        const double t = std::ldexp(random_significand(), random_.below(6) - 3);
        const auto enter = static_cast<std::size_t>(random_.below(3)),
                   leave = (enter + 1 + static_cast<std::size_t>(random_.below(2))) % 3;
        for (std::size_t k = 0; k < 3; ++k) {
            point.numbers[6 + k] = file_.ranges[6 + k].low;
            point.numbers[9 + k] = file_.ranges[9 + k].high;
            point.numbers[3 + k] = rounding::to_format(point.numbers[3 + k], 0, row_.format.parameters);
        }
        for (const std::size_t k : {enter, leave}) {
            double& plane = point.numbers[((point.numbers[3 + k] > 0) == (k == enter) ? 6 : 9) + k];
            plane = rounding::to_format(point.numbers[k] + t * point.numbers[3 + k], 0, row_.format.parameters);
            point.numbers[k] = plane - t * point.numbers[3 + k];
        }
    }

    /// Moves the origin along the axis whose slab the ray leaves first, so that the ray leaves this slab at the t at
    /// which it enters the last slab.
    void move_to_edge(SearchPoint& point) {
        double entry = 0, exit = std::numeric_limits<double>::infinity();
        std::size_t leave = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double o = point.numbers[k], d = point.numbers[3 + k];
            if (d == 0) continue;
            entry = std::max(entry, (point.numbers[(d > 0 ? 6 : 9) + k] - o) / d);
            const double exit_of_axis = (point.numbers[(d > 0 ? 9 : 6) + k] - o) / d;
            if (!(exit_of_axis < exit)) continue;
            exit = exit_of_axis;
            leave = k;
        }
        const double d = point.numbers[3 + leave];
        point.numbers[leave] =
            rounding::to_format(point.numbers[(d > 0 ? 9 : 6) + leave] - entry * d, 0, row_.format.parameters);
    }

    /// Moves the centre of the primitive to where a nearer wrong decision may still be found: to a distance between the
    /// smallest allowed and the smallest found so far, uniform in its logarithm.
    void move_primitive_nearer(SearchPoint& point) {
        const double radius = point.numbers[9], low = std::max(1.0, file_.distance_radii.low),
                     high = best_.value < 0x1p100 ? file_.distance_radii.high : best_.distance;
        const Vec<double> origin = point.ray().origin, f = ball_around(point.primitive(file_.shape)).centre - origin;
        const Real distance = Real(low) * pow(Real(high) / Real(low), Real(random_.unit()));
        const double scale = radius * static_cast<double>(distance) / length(f);
        for (std::size_t i = 0; i < 3; ++i)
            point.numbers[6 + i] = origin[static_cast<int>(i)] + scale * f[static_cast<int>(i)];
    }

    /// Turns the direction to a point of the primitive, and keeps the size of its largest component. Random directions
    /// seldom meet a far primitive.
    void aim_at_point(SearchPoint& p) {
        const Primitive<double> primitive = p.primitive(file_.shape);
        const double x = random_.unit(), y = random_.unit(), z = random_.unit();
        const Vec<double> point = visit(primitive, [&](const auto& shape) { return shape.point_at({x, y, z}); });
        double to_point[3], largest = 0, direction_size = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            to_point[i] = point[static_cast<int>(i)] - p.numbers[i];
            largest = std::max(largest, std::fabs(to_point[i]));
            direction_size = std::max(direction_size, std::fabs(p.numbers[3 + i]));
        }
        if (largest == 0) return;
        for (std::size_t i = 0; i < 3; ++i) p.numbers[3 + i] = to_point[i] / largest * direction_size;
    }

    /// Aims at a rim, an edge, an apex or a line of the primitive. The distance of the eye is from every octave equally
    /// often, and the direction keeps the size of its largest component. The numbers of the primitive are rounded
    /// first, so that the point aimed at is on the primitive that the form receives.
    void aim_at_feature(SearchPoint& point) {
        const FloatFormat& format = row_.format.parameters;
        for (std::size_t i = 6; i < file_.ranges.size(); ++i)
            point.numbers[i] = rounding::to_format(point.numbers[i], 0, format);
        const Primitive<double> primitive = point.primitive(file_.shape);
        if (broken_limit(primitive)) return;
        const scene::rays::AimedPlace feature = draw_target_(random_, primitive, *file_.aim);
        const Vec<double> random_direction = scene::rays::draw_direction(random_),
                          d = feature.along.value_or(random_direction);
        const double half_extent = visit(primitive, [](const auto& shape) { return shape.half_extent(); });
        const double eye_distance = half_extent * random_.in_octaves(file_.distance.low, file_.distance.high);
        const double direction_size = std::max(
                         {std::fabs(point.numbers[3]), std::fabs(point.numbers[4]), std::fabs(point.numbers[5])}),
                     largest = std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
        for (std::size_t i = 0; i < 3; ++i) {
            const int k = static_cast<int>(i);
            point.numbers[i] = feature.point[k] - eye_distance * d[k];
            point.numbers[3 + i] = d[k] / largest * direction_size;
        }
    }

    SearchPoint draw_neighbour(const SearchPoint& point, std::size_t begin, std::size_t end, int count) {
        for (int attempt = 0; count > 0 && attempt < 16; ++attempt) {
            SearchPoint p = point;
            for (int k = 0; k < count; ++k) {
                double& x = p.numbers[begin + static_cast<std::size_t>(random_.below(static_cast<int>(end - begin)))];
                x = file_.exponents && random_.below(2) == 0 ? flip_bit(x) : step_randomly(x);
            }
            if (file_.at_edge && random_.below(2) == 0) move_to_edge(p);
            if (file_.contains(p.ray(), p.primitive(file_.shape))) return p;
        }
        return point;
    }

    double step_randomly(double x) {
        const auto steps = std::int64_t{1} << random_.below(row_.format.parameters.precision + 2);
        return move_by_steps(x, random_.below(2) == 0 ? steps : -steps, row_.format.parameters);
    }

    /// x with one bit of its significand flipped, or twice x, or half of it.
    double flip_bit(double x) {
        const FloatFormat& f = row_.format.parameters;
        const int bit = random_.below(f.precision + 1) - 2;
        if (bit < 0) return rounding::to_format(bit == -1 ? 2 * x : x / 2, 0, f);
        const std::int64_t n = truth::ordinal(std::fabs(x), f), flipped = n ^ (std::int64_t{1} << bit);
        return std::copysign(move_by_steps(std::fabs(x), flipped - n, f), x);
    }

    BatchWorst measure_batch(const std::vector<SearchPoint>& candidates) {
        scene::rays::RayBlock rays;
        for (const SearchPoint& point : candidates) rays.push(point.ray());
        rays.mark_as_list();
        evaluations_ += candidates.size();
        truth::Band band(std::move(rays), {candidates.front().primitive(file_.shape)}, request_.limit);
        const evaluate::SharedBandTruth shared(band, {row_}, request_.metrics);
        evaluate::FormSummary summary(request_.metrics);
        BatchWorst batch_worst(metric_, row_.form->info->direction, file_);
        evaluate::measure_form(
            {row_, request_.metrics, [&batch_worst](const auto& result) { batch_worst.add(result); }},
            shared.inputs_of(row_), summary);
        return batch_worst;
    }

    void store_if_worse(const BatchWorst& batch_worst, const SearchPoint& candidate) {
        if (!(batch_worst.score > best_score_)) return;
        best_score_ = batch_worst.score;
        best_ = {.outcome = batch_worst.outcome,
                 .value = file_.is_minimised ? 1 / batch_worst.score : batch_worst.score,
                 .ray = candidate.ray(),
                 .primitive = candidate.primitive(file_.shape),
                 .t = batch_worst.t,
                 .truth = batch_worst.truth,
                 .distance = file_.is_round()
                                 ? scene::sweep::distance_in_radii(candidate.ray(), candidate.primitive(file_.shape))
                                 : truth::missing};
    }

    const WorstRequest& request_;
    const scene::sweep::SearchFile& file_;
    const evaluate::TestedForm& row_;
    decltype(scene::sweep::DistributionRow::draw_target) draw_target_ =
        std::ranges::find(scene::sweep::distributions(), file_.shape, &scene::sweep::DistributionRow::shape)
            ->draw_target;
    scene::rays::Random random_;
    std::size_t metric_;
    std::uint64_t evaluations_ = 0;
    double best_score_ = -1;  ///< the metric, or its reciprocal if the smallest value is searched
    WorstResult best_;
};

}  // namespace

std::vector<std::optional<WorstResult>> find_worst(const WorstRequest& request) {
    const auto units = request.share.unit_range(request.tested_forms.size());
    std::vector<std::optional<WorstResult>> found(units.size());
    intersect::process::in_parallel(std::size_t{0}, found.size(), [&](std::size_t i) {
        found[i] = WorstSearch(request, request.tested_forms[units.first + i]).run();
        request.progress(1);
    });
    return found;
}

}  // namespace lostbits::measure::sweep
