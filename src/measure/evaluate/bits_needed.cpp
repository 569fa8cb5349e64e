#include "measure/evaluate/bits_needed.hpp"

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

/// Inputs that a form receives for some pixels of a band.
FormatInputs inputs_of_pixels(const FormatInputs& all, const intersect::Info& info,
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

/// Scan of one form over a part of a band; `pixels` are those on which every precision so far was enough.
struct Scan {
    std::size_t form_index;  ///< index in the study
    std::vector<std::uint32_t> pixels;
};

/// Tests the next smaller precision. Pixels on which it fails get their value and leave the scan.
void test_precision(Scan& scan, const intersect::table::Intersector& form, const FormatInputs& inputs, int correct_bits,
                    BitsNeededBand& result) {
    if (scan.pixels.empty()) return;
    const int precision = inputs.format.parameters.precision;
    const answer::Answers answers = answer::evaluate(form, inputs_of_pixels(inputs, *form.info, scan.pixels));
    const bool returns_t = form.info->roots != intersect::Roots::none;

    // Pixels that stay in the scan move to its front.
    std::size_t kept_count = 0;
    for (std::size_t k = 0; k < scan.pixels.size(); ++k) {
        const std::uint32_t i = scan.pixels[k];
        const bool is_wrong_primitive =
            returns_t && !answer::meets_first(*result.band, i, answers.primitive[k], form.info->convention());
        if (is_precision_enough(result.truth(i), *form.info, precision,
                                {answers.hit[k] != 0, answers.t[k], is_wrong_primitive ? answers.primitive[k] : -1},
                                correct_bits))
            scan.pixels[kept_count++] = i;
        else result.bits_needed[i] = precision == max_precision ? beyond_max_precision : precision + 1;
    }
    scan.pixels.resize(kept_count);
}

/// Scans of every form over every part of the band. The parts depend on the picture alone.
std::vector<Scan> make_scans(const std::vector<BitsNeededBand>& results) {
    constexpr std::size_t part_size = 2048;  // small enough to share among threads, large enough for a batch to pay
    std::vector<Scan> scans;
    for (std::size_t f = 0; f < results.size(); ++f) {
        const std::size_t n = results[f].bits_needed.size();
        for (std::size_t begin = 0; begin < n; begin += part_size) {
            Scan scan{.form_index = f, .pixels = {}};
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

bool has_correct_bits(double t, const truth::CertifiedNumber& true_t, int correct_bits) {
    if (!std::isfinite(t)) return false;
    const long ulp = ulp_exponent({correct_bits, binary64.emin, binary64.emax}, true_t.floor_log2());
    return std::fabs(truth::scaled_difference(truth::as_certified(t), true_t, ulp)) <= 0.5;
}

bool is_precision_enough(const Truth& ray_truth, const intersect::Info& info, int precision, Answer form_answer,
                         int correct_bits) {
    switch (answer::classify(ray_truth.decision, form_answer.hit, form_answer.t)) {
        case answer::Outcome::agree_miss: return true;
        case answer::Outcome::agree_hit:
            return precision >= correct_bits &&
                   (form_answer.primitive_index < 0 || form_answer.primitive_index == ray_truth.primitive) &&
                   has_correct_bits(form_answer.t, info.direction == Direction::unit ? ray_truth.distance : ray_truth.t,
                                    correct_bits);
        default: return false;
    }
}

void BitsNeededSummary::add(const Truth& ray_truth, double bits_needed) {
    if (std::isnan(bits_needed)) {
        ++unresolved;
    } else if (bits_needed == beyond_max_precision) {
        ++(ray_truth.is_hit() ? hits_beyond : misses_beyond);
    } else {
        ++(ray_truth.is_hit() ? hits : misses)[static_cast<std::size_t>(bits_needed)];
    }
}

void BitsNeededSummary::append(const BitsNeededSummary& other) {
    for (std::size_t p = 0; p < hits.size(); ++p) {
        hits[p] += other.hits[p];
        misses[p] += other.misses[p];
    }
    hits_beyond += other.hits_beyond;
    misses_beyond += other.misses_beyond;
    unresolved += other.unresolved;
}

PrecisionCounts BitsNeededSummary::all() const {
    PrecisionCounts sum = hits;
    for (std::size_t p = 0; p < sum.size(); ++p) sum[p] += misses[p];
    return sum;
}

std::uint64_t BitsNeededSummary::pixel_count() const {
    return all().count() + hits_beyond + misses_beyond + unresolved;
}

std::uint64_t PrecisionCounts::count() const { return std::accumulate(begin(), end(), std::uint64_t{0}); }

double PrecisionCounts::mean() const {
    std::uint64_t sum = 0;
    for (std::size_t p = 0; p < size(); ++p) sum += p * (*this)[p];
    const std::uint64_t n = count();
    return n == 0 ? missing : static_cast<double>(sum) / static_cast<double>(n);
}

double PrecisionCounts::quantile(double q) const {
    const std::uint64_t n = count();
    if (n == 0) return missing;

    const auto rank =
        std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(n))), 1, n);
    std::uint64_t seen = 0;
    std::size_t p = 0;
    while ((seen += (*this)[p]) < rank) ++p;
    return static_cast<double>(p);
}

std::uint64_t BitsNeededStudy::units() const {
    constexpr std::uint64_t precisions = max_precision - min_precision + 1;
    return scene.pixel_count() * tested_forms.size() * precisions;
}

std::vector<BitsNeededBand> BitsNeededStudy::prepare(const truth::Band& band) const {
    std::vector<BitsNeededBand> results;
    for (const intersect::table::Intersector* form : tested_forms) {
        const int picture_width = static_cast<int>(band.pixel_count()) / std::max(1, band.scanlines());
        results.push_back({.y0 = band.y0(),
                           .scanlines = band.scanlines(),
                           .width = picture_width,
                           .band = &band,
                           .form = form->info,
                           .bits_needed = std::vector<double>(band.pixel_count(), missing)});
    }

    // A pixel leaves its scan at the first precision, from the largest down, that is not enough.
    std::vector<Scan> scans = make_scans(results);
    for (int precision = max_precision; precision >= min_precision; --precision) {
        const auto needs_unit_rays = [&](const Scan& scan) {
            return !scan.pixels.empty() && results[scan.form_index].form->direction == Direction::unit;
        };
        if (!std::ranges::all_of(scans, [](const Scan& scan) { return scan.pixels.empty(); })) {
            const FormatInputs inputs = band.inputs(*find_format("p" + std::to_string(precision)),
                                                    {.unit_rays = std::ranges::any_of(scans, needs_unit_rays)});
            intersect::process::in_parallel(std::size_t{0}, scans.size(), [&](std::size_t s) {
                test_precision(scans[s], *tested_forms[scans[s].form_index], inputs, correct_bits,
                               results[scans[s].form_index]);
            });
        }
        if (precision > min_precision)
            progress(band.pixel_count() * tested_forms.size());  // the driver counts the last one
    }

    // The smallest precision is enough for the pixels that are left.
    for (const Scan& scan : scans) {
        for (const std::uint32_t i : scan.pixels) results[scan.form_index].bits_needed[i] = min_precision;
    }
    return results;
}

void BitsNeededStudy::measure(const std::vector<BitsNeededBand>& bands, std::size_t form_index,
                              BitsNeededSummary& summary, const std::function<void(const BitsNeededBand&)>& show) {
    const BitsNeededBand& band = bands[form_index];
    for (std::size_t i = 0; i < band.bits_needed.size(); ++i) summary.add(band.truth(i), band.bits_needed[i]);
    show(band);
}

}  // namespace lostbits::measure::evaluate
