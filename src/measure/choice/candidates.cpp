#include "measure/choice/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>

#include "intersect/simd/packed.hpp"
#include "measure/choice/file_rays.hpp"

namespace lostbits::measure::choice {

using intersect::Target;
using intersect::table::HitBatch;
using intersect::table::RayBatch;
using map::MapRow;
using scene::file::Scene;

namespace {

constexpr int timed_pixels = 2048;
constexpr std::size_t most_solids = 4;

/// Rays of a format in columns, and room for the answers.
template <class S>
class Columns {
public:
    explicit Columns(const scene::rays::RayBlock& rays) {
        const std::array from{&rays.ox, &rays.oy, &rays.oz, &rays.dx, &rays.dy, &rays.dz};
        for (std::size_t c = 0; c < from.size(); ++c)
            std::ranges::transform(*from[c], std::back_inserter(in_[c]), [](double x) { return static_cast<S>(x); });
        for (auto& out : out_) out.resize(rays.size());
        hit_.resize(rays.size());
    }
    [[nodiscard]] RayBatch<S> rays() const { return {in_[0], in_[1], in_[2], in_[3], in_[4], in_[5]}; }
    [[nodiscard]] HitBatch<S> hits() { return {out_[0], out_[1], out_[2], hit_}; }

private:
    std::array<std::vector<S>, 6> in_;
    std::array<std::vector<S>, 3> out_;
    std::vector<std::uint8_t> hit_;
};

/// What is timed: the band's rays against some of its solids.
struct ToTime {
    truth::Band band;
    std::size_t solids;
    /// Of a solid, the first that has the same numbers: where each ray has its own, many may be one.
    std::function<int(int)> first_same;
};

ToTime to_time(const ChoiceRequest& request) {
    if (request.scene) {
        const Scene thin = thinned(*request.scene, timed_pixels);
        return {truth::Band(thin, 0, thin.height, request.limit), thin.solid_count(), std::identity{}};
    }
    const scene::rays::RayGroup& sample = request.rays->sample;
    std::map<std::array<double, 6>, int> places;
    std::vector<int> first;
    for (const Solid<double>& solid : sample.solids)
        first.push_back(places.emplace(solid.numbers, static_cast<int>(first.size())).first->second);
    return {truth::Band(sample, request.limit), sample.solids.size(),
            [first = std::move(first)](int solid) { return first[static_cast<std::size_t>(solid)]; }};
}

/// The solids that most rays of the band truly hit first; the first ones where none is hit.
std::vector<std::size_t> solids_to_time(const ToTime& timed) {
    const auto& [band, solids, first_same] = timed;
    std::map<int, std::size_t> hits;
    for (std::size_t i = 0; i < band.pixels(); ++i) {
        const truth::Truth truth = band.truth(i, {});
        if (truth.is_hit()) ++hits[first_same(truth.object)];
    }
    std::vector<std::pair<std::size_t, int>> order;
    for (const auto& [solid, count] : hits) order.emplace_back(count, solid);
    std::ranges::sort(order, [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    std::vector<std::size_t> chosen;
    for (const auto& [count, solid] : order) chosen.push_back(static_cast<std::size_t>(solid));
    if (chosen.empty()) {
        chosen.resize(solids);
        std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    }
    if (chosen.size() > most_solids) chosen.resize(most_solids);
    return chosen;
}

template <class S>
speed::TimedWork work_on(const intersect::table::Kernel<S>& kernel, const scene::rays::RayBlock& rays,
                         std::vector<Solid<S>> solids) {
    const auto columns = std::make_shared<Columns<S>>(rays);
    const std::size_t items = rays.size() * solids.size();
    return {[kernel, columns, all = std::move(solids)] {
                for (const Solid<S>& solid : all) kernel(columns->rays(), Target<S>(solid), columns->hits());
            },
            items, true};
}

}  // namespace

Scene thinned(const Scene& scene, int pixels) {
    Scene thin = scene;
    const double factor = std::min(1.0, std::sqrt(static_cast<double>(pixels) / static_cast<double>(scene.pixels())));
    const auto shrunk = [factor](int side) { return std::max(1, static_cast<int>(std::lround(side * factor))); };
    thin.width = shrunk(scene.width);
    thin.height = shrunk(scene.height);
    return thin;
}

std::vector<Worth> worth_of(const ChoiceRequest& request) {
    const metric::Metric* const lost = metric::find_metric("lost_bits");
    map::MapRequest asked{.scene = request.scene, .rows = request.rows, .metrics = {lost}};
    asked.limit = request.limit;
    asked.progress = request.progress;
    auto sinks = request.sinks;
    sinks.resize(request.rows.size(), nullptr);
    const auto summaries = map::run_map(asked, sinks);
    std::vector<Worth> all;
    for (std::size_t r = 0; r < summaries.size(); ++r)
        all.push_back(worth_of(summaries[r], request.rows[r], request.wish));
    return all;
}

const std::string& ChoiceRequest::id() const { return scene ? scene->id : rays->id; }

Worth worth_of(const map::MapSummary& s, const MapRow& row, const Wish& wish) {
    return {.rays = s.rays - s.count(answer::Outcome::unresolved),
            .wrong = s.wrong_count(),
            .first = s.wrong(),
            .kept_bits = row.format.shape.precision - s.metrics[0].quantile(wish.quantile),
            .hits = s.true_hits};
}

truth::BandNeeds needs_of(const MapRow& row) {
    return {.unit_rays = row.form->info->direction == intersect::Direction::unit};
}

Worth worth_on(const truth::Band& band, const MapRow& row, const Wish& wish) {
    return worth_on(band, band.inputs(row.format, needs_of(row)), row, wish);
}

Worth worth_on(const truth::Band& band, const truth::FormatInputs& inputs, const MapRow& row, const Wish& wish) {
    const std::vector<const metric::Metric*> lost{metric::find_metric("lost_bits")};
    map::MapSummary summary(lost);
    map::measure_row({row, lost}, band, inputs, summary);
    return worth_of(summary, row, wish);
}

std::vector<Candidate> measure_candidates(const ChoiceRequest& request, TimedRays& timed) {
    const auto worth = request.scene ? worth_of(request) : request.rays->worth;
    std::vector<Candidate> all;
    const ToTime sample = to_time(request);
    const truth::Band& band = sample.band;
    const auto solids = solids_to_time(sample);
    timed = {band.pixels(), solids.size()};
    std::map<std::string, truth::FormatInputs> inputs;
    std::vector<speed::TimedWork> work;
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        const MapRow& row = request.rows[r];
        const intersect::simd::Isa isa = request.single || !is_packed(*row.form, intersect::simd::current_isa())
                                             ? intersect::simd::Isa::scalar
                                             : intersect::simd::current_isa();
        all.push_back({row, name_of(isa), {}, worth[r]});
        auto found = inputs.find(row.format.name);
        if (found == inputs.end())
            found =
                inputs.emplace(row.format.name, band.inputs(row.format, {.unit_rays = true, .own_truth = false})).first;
        const truth::FormatInputs& in = found->second;
        const intersect::simd::PackedRow kernels =
            isa == intersect::simd::Isa::scalar
                ? intersect::simd::PackedRow{row.form->info, row.form->native32, row.form->native64}
                : packed_kernels(*row.form, isa);
        std::vector<Solid<double>> wide;
        for (const std::size_t s : solids) wide.push_back(in.solids[s]);
        if (row.format.engine == Format::Engine::native32) {
            std::vector<Solid<float>> narrow;
            for (const Solid<double>& s : wide)
                narrow.push_back(transformed(s, [](double x) { return static_cast<float>(x); }));
            work.push_back(work_on<float>(kernels.f32, in.rays_for(*row.form->info), std::move(narrow)));
        } else {
            work.push_back(work_on<double>(kernels.f64, in.rays_for(*row.form->info), std::move(wide)));
        }
    }
    const auto timings = time_interleaved(work, request.plan);
    for (std::size_t c = 0; c < all.size(); ++c) all[c].time = timings[c];
    return all;
}

namespace {

/// The place of the least by `less`, among those that `fit`.
template <class Fit, class Less>
std::optional<std::size_t> least_of(const std::vector<Candidate>& all, const Fit& fit, const Less& less) {
    std::optional<std::size_t> best;
    for (std::size_t c = 0; c < all.size(); ++c) {
        if (fit(all[c]) && (!best || less(all[c], all[*best]))) best = c;
    }
    return best;
}

bool takes_less(const Candidate& a, const Candidate& b) { return a.time.median < b.time.median; }

/// NaN keeps nothing.
double bits_of(const Candidate& c) { return std::isnan(c.worth.kept_bits) ? -1 : c.worth.kept_bits; }

bool is_more_accurate(const Candidate& a, const Candidate& b) {
    const double wrong_a = a.worth.wrong_fraction(), wrong_b = b.worth.wrong_fraction();
    return wrong_a != wrong_b ? wrong_a < wrong_b : bits_of(a) > bits_of(b);
}

}  // namespace

std::optional<std::size_t> cheapest(const std::vector<Candidate>& all, const Wish& wish) {
    return least_of(
        all, [&wish](const Candidate& c) { return c.worth.meets(wish); }, takes_less);
}

std::optional<std::size_t> fastest(const std::vector<Candidate>& all) {
    return least_of(
        all, [](const Candidate&) { return true; }, takes_less);
}

std::optional<std::size_t> most_accurate(const std::vector<Candidate>& all) {
    return least_of(
        all, [](const Candidate&) { return true; }, is_more_accurate);
}

std::optional<std::size_t> nearest(const std::vector<Candidate>& all, const Wish& wish) {
    const auto deciding = least_of(
        all, [&wish](const Candidate& c) { return c.worth.decides(wish); },
        [](const Candidate& a, const Candidate& b) { return bits_of(a) > bits_of(b); });
    return deciding ? deciding : most_accurate(all);
}

}  // namespace lostbits::measure::choice
