#include "measure/evaluate/needed.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "intersect/process/parallel.hpp"
#include "measure/answer/answers.hpp"
#include "measure/answer/outcome.hpp"
#include "measure/answer/owners.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::evaluate {

using intersect::Direction;
using truth::FormatInputs;
using truth::missing;
using truth::Truth;

namespace {

/// The rays `pixels` of the inputs that a form receives.
FormatInputs select_pixels(const FormatInputs& all, const intersect::Info& info,
                           const std::vector<std::uint32_t>& pixels) {
    FormatInputs selected{.format = all.format, .primitives = all.primitives, .march = all.march, .stop = all.stop};
    const scene::rays::RayBlock& source = all.rays_for(info);
    scene::rays::RayBlock& destination = info.direction == Direction::unit ? selected.unit_rays : selected.rays;
    for (std::size_t c = 0; c < destination.numbers().size(); ++c) {
        destination.numbers()[c]->resize(pixels.size());
        std::ranges::transform(pixels, destination.numbers()[c]->begin(),
                               [&x = *source.numbers()[c]](std::uint32_t i) { return x[i]; });
    }
    if (all.candidates) selected.candidates = std::make_shared<culling::CandidateLists>(*all.candidates, pixels);
    return selected;
}

/// Scan of one form over a part of a band; `pixels` are those on which every width so far has sufficed.
struct Scan {
    std::size_t form;  ///< index in the study
    std::vector<std::uint32_t> pixels;
};

/// Tests the next smaller width. Pixels on which this width fails get their value and leave the scan.
void test_width(Scan& scan, const intersect::table::Intersector& form, const FormatInputs& inputs, int bits,
                NeededBand& result) {
    if (scan.pixels.empty()) return;
    const int width = inputs.format.parameters.precision;
    const answer::Answers answers = answer::evaluate(form, select_pixels(inputs, *form.info, scan.pixels));
    const bool tells_t = form.info->roots != intersect::Roots::none;
    std::size_t kept_count = 0;
    for (std::size_t k = 0; k < scan.pixels.size(); ++k) {
        const std::uint32_t i = scan.pixels[k];
        const bool is_wrong_primitive =
            tells_t && !answer::meets_first(*result.band, i, answers.object[k], form.info->convention());
        if (suffices(result.truth(i), *form.info, width,
                     {answers.hit[k] != 0, answers.t[k], is_wrong_primitive ? answers.object[k] : -1}, bits))
            scan.pixels[kept_count++] = i;
        else result.needed[i] = width == most_width ? needed_beyond : width + 1;
    }
    scan.pixels.resize(kept_count);
}

/// Scans of every form over every part of the band. The parts depend on the picture alone.
std::vector<Scan> scans_of(const std::vector<NeededBand>& results) {
    constexpr std::size_t part_size = 2048;  // small enough to share among threads, large enough for a batch to pay
    std::vector<Scan> scans;
    for (std::size_t f = 0; f < results.size(); ++f) {
        const std::size_t n = results[f].needed.size();
        for (std::size_t begin = 0; begin < n; begin += part_size) {
            Scan scan{f, {}};
            for (std::size_t i = begin; i < std::min(n, begin + part_size); ++i) {
                if (results[f].truth(i).decision != Truth::Decision::unresolved)
                    scan.pixels.push_back(static_cast<std::uint32_t>(i));
            }
            scans.push_back(std::move(scan));
        }
    }
    return scans;
}

}  // namespace

bool keeps_bits(double t, const truth::Certified& truth, int bits) {
    if (!std::isfinite(t)) return false;
    const long ulp = ulp_exponent({bits, binary64.emin, binary64.emax}, truth.floor_log2());
    return std::fabs(truth::scaled_difference(truth::as_certified(t), truth, ulp)) <= 0.5;
}

bool suffices(const Truth& truth, const intersect::Info& form, int width, Answer form_answer, int bits) {
    switch (answer::classify(truth.decision, form_answer.hit, form_answer.t)) {
        case answer::Outcome::agree_miss: return true;
        case answer::Outcome::agree_hit:
            return width >= bits && (form_answer.object < 0 || form_answer.object == truth.primitive) &&
                   keeps_bits(form_answer.t, form.direction == Direction::unit ? truth.distance : truth.t, bits);
        default: return false;
    }
}

void NeededSummary::add(const Truth& truth, double needed) {
    if (std::isnan(needed)) {
        ++unresolved;
    } else if (needed == needed_beyond) {
        ++(truth.is_hit() ? hits_beyond : misses_beyond);
    } else {
        ++(truth.is_hit() ? hits : misses)[static_cast<std::size_t>(needed)];
    }
}

void NeededSummary::append(const NeededSummary& other) {
    for (std::size_t w = 0; w < hits.size(); ++w) {
        hits[w] += other.hits[w];
        misses[w] += other.misses[w];
    }
    hits_beyond += other.hits_beyond;
    misses_beyond += other.misses_beyond;
    unresolved += other.unresolved;
}

WidthCounts NeededSummary::all() const {
    WidthCounts sum = hits;
    for (std::size_t w = 0; w < sum.size(); ++w) sum[w] += misses[w];
    return sum;
}

std::uint64_t NeededSummary::pixels() const { return all().count() + hits_beyond + misses_beyond + unresolved; }

std::uint64_t WidthCounts::count() const { return std::accumulate(begin(), end(), std::uint64_t{0}); }

double WidthCounts::mean() const {
    std::uint64_t sum = 0;
    for (std::size_t w = 0; w < size(); ++w) sum += w * (*this)[w];
    const std::uint64_t n = count();
    return n == 0 ? missing : static_cast<double>(sum) / static_cast<double>(n);
}

double WidthCounts::quantile(double q) const {
    const std::uint64_t n = count();
    if (n == 0) return missing;
    const auto rank =
        std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(n))), 1, n);
    std::uint64_t seen = 0;
    std::size_t w = 0;
    while ((seen += (*this)[w]) < rank) ++w;
    return static_cast<double>(w);
}

std::uint64_t NeededStudy::units() const {
    constexpr std::uint64_t widths = most_width - least_width + 1;
    return scene.pixels() * rows.size() * widths;
}

std::vector<NeededBand> NeededStudy::prepare(const truth::Band& band) const {
    std::vector<NeededBand> results;
    for (const intersect::table::Intersector* form : rows) {
        const int columns = static_cast<int>(band.pixels()) / std::max(1, band.rows());
        results.push_back({.y0 = band.y0(),
                           .rows = band.rows(),
                           .width = columns,
                           .band = &band,
                           .form = form->info,
                           .needed = std::vector<double>(band.pixels(), missing)});
    }
    std::vector<Scan> scans = scans_of(results);
    for (int width = most_width; width >= least_width; --width) {
        const auto needs_unit_rays = [&](const Scan& s) {
            return !s.pixels.empty() && results[s.form].form->direction == Direction::unit;
        };
        if (!std::ranges::all_of(scans, [](const Scan& s) { return s.pixels.empty(); })) {
            const FormatInputs inputs = band.inputs(*find_format("p" + std::to_string(width)),
                                                    {.unit_rays = std::ranges::any_of(scans, needs_unit_rays)});
            intersect::process::in_parallel(std::size_t{0}, scans.size(), [&](std::size_t s) {
                test_width(scans[s], *rows[scans[s].form], inputs, bits, results[scans[s].form]);
            });
        }
        if (width > least_width) progress(band.pixels() * rows.size());  // the driver counts the last width
    }
    for (const Scan& s : scans) {
        for (const std::uint32_t i : s.pixels) results[s.form].needed[i] = least_width;
    }
    return results;
}

void NeededStudy::measure(const std::vector<NeededBand>& bands, std::size_t row_index, NeededSummary& summary,
                          const std::function<void(const NeededBand&)>& show) {
    const NeededBand& band = bands[row_index];
    for (std::size_t i = 0; i < band.needed.size(); ++i) summary.add(band.truth(i), band.needed[i]);
    show(band);
}

}  // namespace lostbits::measure::evaluate
