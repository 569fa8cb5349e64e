// The driver of studies. A study measures rows (a form in a format, and perhaps more) over the pixels of a scene. It is
// a struct with these members, whose summaries list their fields (`LOSTBITS_FIELDS`):
//
// - `scene`, `rows`, `limit`: the subject, and when to stop;
// - `share`: the share of the bands that this run measures;
// - `progress`: called with the number of pixels after each band of a row;
// - `Band`, `Summary`: the results of a row on a band, and over the picture;
// - `pixels_per_band`: about how many pixels a band has;
// - `require()`: throws InputError for a scene that cannot be measured;
// - `begin(row_index)`: returns an empty summary of the row;
// - `prepare(band)`: returns everything that the rows of a band share, their truth above all;
// - `measure(shared, row_index, summary)`: measures a row on a band, adds to its summary, and returns the results to
//   show (`ShowBand`).
//
// A study may also have
//
// - `scenes()`: the scenes of its rows, if rows differ in the rays that a scene makes;
// - `prepare(band, rows)`, in place of `prepare(band)`: `rows` are the rows whose rays are in this band;
// - `measure(shared, row_index, summary, show)`: calls `show` with the results to show, in memory that it reuses;
// - `stages`: receives the number of truths that each stage settled; may be null.
//
// The driver owns the loop over bands and rows, their threads, the share of a shard, and how summaries add up.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <vector>

#include "intersect/process/parallel.hpp"
#include "measure/study/bands.hpp"
#include "measure/study/sums.hpp"

namespace lostbits::measure::study {

/// Receives the results of each row, band by band from top to bottom. It is called for several rows at the same time.
/// May be empty.
template <class Study>
using ShowBand = std::function<void(std::size_t row_index, const typename Study::Band& band)>;

/// Rows whose rays are the same, and the scene that makes these rays.
struct RowsOfScene {
    std::shared_ptr<const scene::file::Scene> scene;
    std::vector<std::size_t> rows;  ///< indices in the study
};

/// Returns a pointer to a scene that it does not own; the scene must outlive it.
inline std::shared_ptr<const scene::file::Scene> non_owning_pointer(const scene::file::Scene& scene) {
    return {std::shared_ptr<void>(), &scene};
}

/// Returns the scenes of a study's rows. A study without `scenes()` has one scene, which must outlive the result.
template <class S>
std::vector<RowsOfScene> scenes_of(const S& study) {
    if constexpr (requires { study.scenes(); }) {
        return study.scenes();
    } else {
        RowsOfScene all_rows{non_owning_pointer(study.scene), std::vector<std::size_t>(study.rows.size())};
        std::iota(all_rows.rows.begin(), all_rows.rows.end(), std::size_t{0});
        return {std::move(all_rows)};
    }
}

/// Prepares everything that these rows of a band share.
template <class S>
decltype(auto) prepare_band(const S& study, truth::Band& band, const std::vector<std::size_t>& rows) {
    if constexpr (requires { study.prepare(band, rows); }) return study.prepare(band, rows);
    else return study.prepare(band);
}

/// Measures a row on a band, adds to its summary, and shows the results of the band.
template <class S, class Shared>
void measure_row(const S& study, const Shared& shared, std::size_t row_index, typename S::Summary& summary,
                 const ShowBand<S>& show) {
    const auto show_band = [&](const typename S::Band& band) {
        if (show) show(row_index, band);
    };
    if constexpr (requires { study.measure(shared, row_index, summary, show_band); })
        study.measure(shared, row_index, summary, show_band);
    else show_band(study.measure(shared, row_index, summary));
}

template <class S>
concept Study = requires(const S& study, truth::Band& band, std::size_t row_index, typename S::Summary& summary,
                         const ShowBand<S>& show) {
    study.require();
    { study.begin(row_index) } -> std::same_as<typename S::Summary>;
    measure_row(study, prepare_band(study, band, {}), row_index, summary, show);
    { S::pixels_per_band } -> std::convertible_to<int>;
    { study.share } -> std::convertible_to<shard::Share>;
    study.progress(band.pixels());
    study.rows.size();
};

/// Returns the limit of the truth of a band. The study's own limit may have another type.
template <class Limit>
truth::ProofLimit truth_limit(const Limit& limit) {
    if constexpr (std::same_as<Limit, truth::ProofLimit>) return limit;
    else return {.stop = limit.stop};
}

/// Returns an empty summary for each row.
template <Study S>
std::vector<typename S::Summary> begin_all(const S& study) {
    std::vector<typename S::Summary> summaries;
    for (std::size_t row_index = 0; row_index < study.rows.size(); ++row_index)
        summaries.push_back(study.begin(row_index));
    return summaries;
}

/// Measures all rows on the study's share of the bands; one summary for each. Results do not depend on the number of
/// threads or the width of registers.
template <Study S>
std::vector<typename S::Summary> run_share(const S& study, const ShowBand<S>& show = {}) {
    study.require();
    auto summaries = begin_all(study);
    for (const RowsOfScene& scene_rows : scenes_of(study)) {
        const Bands bands(*scene_rows.scene, study.share, S::pixels_per_band);
        bands.each(truth_limit(study.limit), [&](truth::Band& band) {
            if constexpr (requires { *study.stages += band.stages(); })
                if (study.stages) *study.stages += band.stages();
            const auto& shared = prepare_band(study, band, scene_rows.rows);
            intersect::process::in_parallel(std::size_t{0}, scene_rows.rows.size(), [&](std::size_t k) {
                const std::size_t row_index = scene_rows.rows[k];
                measure_row(study, shared, row_index, summaries[row_index], show);
                study.progress(band.pixels());
            });
        });
    }
    return summaries;
}

/// Measures all rows on all bands. The summaries are sealed.
template <Study S>
std::vector<typename S::Summary> run_study(const S& study, const ShowBand<S>& show = {}) {
    auto summaries = run_share(study, show);
    seal_all(summaries);
    return summaries;
}

}  // namespace lostbits::measure::study
