// The driver of studies. A study measures tested forms (a form in a format, and perhaps more) over the pixels of a
// scene. It is a struct with these members, whose summaries list their fields (`LOSTBITS_FIELDS`):
//
// - `scene`, `tested_forms`, `limit`: the subject, and when to stop;
// - `share`: the share of the bands that this run measures;
// - `progress`: called with the number of pixels after each band of a form;
// - `Band`, `Summary`: the results of a form on a band, and over the picture;
// - `pixels_per_band`: about how many pixels a band has;
// - `require()`: throws InputError for a scene that cannot be measured;
// - `begin(form_index)`: returns an empty summary of the form;
// - `prepare(band)`: returns everything that the forms share on a band, their truth above all;
// - `measure(shared, form_index, summary)`: measures a form on a band, adds to its summary, and returns the results to
//   show (`ShowBand`).
//
// A study may also have
//
// - `scenes()`: the scenes of its forms, if forms differ in the rays that a scene makes;
// - `prepare(band, form_indices)`, in place of `prepare(band)`: the forms whose rays are in this band;
// - `measure(shared, form_index, summary, show)`: calls `show` with the results, in memory that it reuses;
// - `stages`: a pointer to the number of truths that each stage has proved; may be null.
//
// The driver owns the loop over bands and forms, their threads, the share of a shard, and how summaries add up.
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

/// Receives the results of each form, band by band from top to bottom. It is called for several forms at the same
/// time. May be empty.
template <class Study>
using ShowBand = std::function<void(std::size_t form_index, const typename Study::Band& band)>;

/// Forms whose rays are the same, and the scene that makes these rays.
struct FormsOfScene {
    std::shared_ptr<const scene::file::Scene> scene;
    std::vector<std::size_t> form_indices;  ///< indices in `tested_forms` of the study
};

/// Returns a pointer to a scene that it does not own; the scene must outlive it.
inline std::shared_ptr<const scene::file::Scene> non_owning_pointer(const scene::file::Scene& scene) {
    return {std::shared_ptr<void>(), &scene};
}

/// Returns the scenes of a study's forms. A study without `scenes()` has one scene, which must outlive the result.
template <class S>
std::vector<FormsOfScene> scenes_of(const S& study) {
    if constexpr (requires { study.scenes(); }) {
        return study.scenes();
    } else {
        FormsOfScene all_forms{non_owning_pointer(study.scene), std::vector<std::size_t>(study.tested_forms.size())};
        std::iota(all_forms.form_indices.begin(), all_forms.form_indices.end(), std::size_t{0});
        return {std::move(all_forms)};
    }
}

/// Prepares everything that these forms share on a band.
template <class S>
decltype(auto) prepare_band(const S& study, truth::Band& band, const std::vector<std::size_t>& form_indices) {
    if constexpr (requires { study.prepare(band, form_indices); }) return study.prepare(band, form_indices);
    else return study.prepare(band);
}

/// Measures a form on a band, adds to its summary, and shows the results of the band.
template <class S, class Shared>
void measure_form(const S& study, const Shared& shared, std::size_t form_index, typename S::Summary& summary,
                  const ShowBand<S>& show) {
    const auto show_band = [&](const typename S::Band& band) {
        if (show) show(form_index, band);
    };
    if constexpr (requires { study.measure(shared, form_index, summary, show_band); })
        study.measure(shared, form_index, summary, show_band);
    else show_band(study.measure(shared, form_index, summary));
}

template <class S>
concept Study = requires(const S& study, truth::Band& band, std::size_t form_index, typename S::Summary& summary,
                         const ShowBand<S>& show) {
    study.require();
    { study.begin(form_index) } -> std::same_as<typename S::Summary>;
    measure_form(study, prepare_band(study, band, {}), form_index, summary, show);
    { S::pixels_per_band } -> std::convertible_to<int>;
    { study.share } -> std::convertible_to<shard::Share>;
    study.progress(band.pixel_count());
    study.tested_forms.size();
};

/// Returns the limit of the truth of a band. The study's own limit may have another type.
template <class Limit>
truth::ProofLimit truth_limit(const Limit& limit) {
    if constexpr (std::same_as<Limit, truth::ProofLimit>) return limit;
    else return {.stop = limit.stop};
}

/// Returns an empty summary for each tested form.
template <Study S>
std::vector<typename S::Summary> empty_summaries(const S& study) {
    std::vector<typename S::Summary> summaries;
    for (std::size_t form_index = 0; form_index < study.tested_forms.size(); ++form_index)
        summaries.push_back(study.begin(form_index));
    return summaries;
}

/// Measures all forms on the study's share of the bands; one summary for each. Results do not depend on the number of
/// threads or the width of registers.
template <Study S>
std::vector<typename S::Summary> run_share(const S& study, const ShowBand<S>& show = {}) {
    study.require();
    auto summaries = empty_summaries(study);
    for (const FormsOfScene& forms_of_scene : scenes_of(study)) {
        const Bands bands(*forms_of_scene.scene, study.share, S::pixels_per_band);
        bands.for_each_band(truth_limit(study.limit), [&](truth::Band& band) {
            if constexpr (requires { *study.stages += band.stages(); })
                if (study.stages) *study.stages += band.stages();
            const auto& shared = prepare_band(study, band, forms_of_scene.form_indices);
            intersect::process::in_parallel(std::size_t{0}, forms_of_scene.form_indices.size(), [&](std::size_t k) {
                const std::size_t form_index = forms_of_scene.form_indices[k];
                measure_form(study, shared, form_index, summaries[form_index], show);
                study.progress(band.pixel_count());
            });
        });
    }
    return summaries;
}

/// Measures all forms on all bands. Returns one sealed summary per form.
template <Study S>
std::vector<typename S::Summary> run_study(const S& study, const ShowBand<S>& show = {}) {
    auto summaries = run_share(study, show);
    seal_all(summaries);
    return summaries;
}

}  // namespace lostbits::measure::study
