// The driver of studies. A study measures rows (a form in a format, and perhaps more) over the pixels of a scene. It is
// a struct with these members, whose summaries list their fields (`LOSTBITS_FIELDS`):
//
// - `scene`, `rows`, `limit`: the subject, and when to stop;
// - `share`: the share of the bands that this run measures;
// - `progress`: called with the number of pixels after each band of a row;
// - `Band`, `Summary`: the results of a row on a band, and over the picture;
// - `pixels_together`: about how many pixels a band has;
// - `require()`: throws InputError for a scene that cannot be measured;
// - `begin(row)`: the summary of no pixels;
// - `prepare(band)`: everything that the rows of a band share, their truth above all;
// - `measure(shared, row, summary)`: measures a row on a band, adds to its summary, and returns what sinks show.
//
// The driver owns the loop over bands and rows, their threads, the share of a shard, and how summaries add up.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "intersect/process/parallel.hpp"
#include "measure/evaluate/bands.hpp"
#include "measure/study/sums.hpp"

namespace lostbits::measure::study {

/// Receives the bands of each row from top to bottom, different rows at the same time; may be empty.
template <class Study>
using ShowBand = std::function<void(std::size_t row, const typename Study::Band& band)>;

template <class S>
concept Study = requires(const S& study, const truth::Band& band, std::size_t row, typename S::Summary& summary) {
    study.require();
    { study.begin(row) } -> std::same_as<typename S::Summary>;
    { study.measure(study.prepare(band), row, summary) } -> std::same_as<typename S::Band>;
    { S::pixels_together } -> std::convertible_to<int>;
    { study.share } -> std::convertible_to<shard::Share>;
    study.progress(band.pixels());
    study.rows.size();
};

/// Limit of the truth of a band, for a study whose own limit may be another.
template <class Limit>
truth::TruthLimit truth_limit(const Limit& limit) {
    if constexpr (std::same_as<Limit, truth::TruthLimit>) return limit;
    else return {.stop = limit.stop};
}

/// Summaries of no pixels; one for each row.
template <Study S>
std::vector<typename S::Summary> begin_all(const S& study) {
    std::vector<typename S::Summary> all;
    for (std::size_t row = 0; row < study.rows.size(); ++row) all.push_back(study.begin(row));
    return all;
}

/// Measures all rows on the study's share of the bands; one summary for each. Results do not depend on the number of
/// threads or the width of registers.
template <Study S>
std::vector<typename S::Summary> run_share(const S& study, const ShowBand<S>& show = {}) {
    study.require();
    auto all = begin_all(study);
    const evaluate::Bands bands(study.scene, study.share, S::pixels_together);
    bands.each(truth_limit(study.limit), [&](const truth::Band& band) {
        const auto& shared = study.prepare(band);
        intersect::process::in_parallel(std::size_t{0}, study.rows.size(), [&](std::size_t row) {
            const typename S::Band found = study.measure(shared, row, all[row]);
            if (show) show(row, found);
            study.progress(band.pixels());
        });
    });
    return all;
}

/// The same for a whole study. The summaries are sealed.
template <Study S>
std::vector<typename S::Summary> run_study(const S& study, const ShowBand<S>& show = {}) {
    auto all = run_share(study, show);
    seal_all(all);
    return all;
}

}  // namespace lostbits::measure::study
