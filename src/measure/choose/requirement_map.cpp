#include "measure/choose/requirement_map.hpp"

#include "measure/evaluate/map.hpp"

#include <algorithm>
#include <limits>

namespace lostbits::measure::choose {

using answer::Outcome;
using evaluate::TestedForm;

void PassingPixels::add_band(const evaluate::BandResult& result) {
    const std::size_t first = static_cast<std::size_t>(result.y0) * static_cast<std::size_t>(result.width);
    const std::vector<double>& lost_bits = result.metrics.front();
    // A form that answers no t has no lost bits; NaN counts as no bits kept.
    const auto is_accurate = [&](std::size_t i) {
        return precision_ - lost_bits[i] >= requirement_.bits &&
               (!requirement_.has_tolerance() || result.metrics[1][i] <= requirement_.tolerance);
    };
    for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
        const Outcome outcome = result.outcomes[i];
        meets_[first + i] = outcome == Outcome::agree_miss || (outcome == Outcome::agree_hit && is_accurate(i));
        unresolved_[first + i] = outcome == Outcome::unresolved;
    }
}

std::uint64_t PassingPixels::count() const { return static_cast<std::uint64_t>(std::ranges::count(meets_, true)); }

PassingPixelsByForm::PassingPixelsByForm(const ChoiceRequest& request, const std::vector<TestedForm>& forms) {
    for (const TestedForm& tested_form : forms)
        rows.emplace_back(request.scene->pixel_count(), request.requirement, tested_form.format.parameters.precision);
}

namespace {

/// A row with its index, in the order in which rows are tried.
struct RankedForm {
    const PassingPixels* passing_pixels;
    int index;  ///< index of the candidate or of the format
};

/// Index of the first form that meets the requirement at the pixel.
int first_at(const std::vector<RankedForm>& ranked, std::size_t pixel) {
    for (const RankedForm& form : ranked) {
        if (form.passing_pixels->meets(pixel)) return form.index;
    }
    const bool unknown = std::ranges::any_of(
        ranked, [pixel](const RankedForm& form) { return form.passing_pixels->is_unresolved(pixel); });
    return unknown ? RequirementMap::unresolved : RequirementMap::none;
}

/// Formats of the rows, each once, ordered by precision and then by name.
std::vector<Format> formats_of(const std::vector<TestedForm>& tested_forms) {
    std::vector<Format> formats;
    for (const TestedForm& tested_form : tested_forms) {
        const Format format = computing_format(tested_form);
        if (std::ranges::find(formats, format) == formats.end()) formats.push_back(format);
    }
    std::ranges::sort(formats, [](const Format& a, const Format& b) {
        return a.parameters.precision != b.parameters.precision ? a.parameters.precision < b.parameters.precision
                                                                : a.name < b.name;
    });
    return formats;
}

/// Counts how often each index from 0 occurs; negative indices are skipped.
std::vector<std::uint64_t> counts_of(const std::vector<int>& indices, std::size_t index_count) {
    std::vector<std::uint64_t> counts(index_count);
    for (const int index : indices) {
        if (index >= 0) ++counts[index];
    }
    return counts;
}

/// Fills in the members about formats; `meets` belongs to `rows`.
void find_narrowest(RequirementMap& map, const std::vector<TestedForm>& tested_forms,
                    const std::vector<const PassingPixels*>& passing_pixels) {
    map.formats = formats_of(tested_forms);
    std::vector<std::vector<RankedForm>> forms_by_format(map.formats.size());
    for (std::size_t k = 0; k < tested_forms.size(); ++k) {
        const auto index = std::ranges::find(map.formats, computing_format(tested_forms[k])) - map.formats.begin();
        forms_by_format[index].push_back({passing_pixels[k], static_cast<int>(index)});
    }

    // At each pixel, the first format in which any form meets the requirement is the narrowest.
    map.met_by_any_form_pixel_counts.assign(map.formats.size(), 0);
    for (std::size_t i = 0; i < map.pixel_count(); ++i) {
        int narrowest = RequirementMap::none;
        for (std::size_t f = 0; f < forms_by_format.size(); ++f) {
            const int first = first_at(forms_by_format[f], i);
            if (first >= 0) ++map.met_by_any_form_pixel_counts[f];
            if (narrowest < 0 && first != RequirementMap::none) narrowest = first;
        }
        map.narrowest.push_back(narrowest);
    }

    map.narrowest_pixel_counts = counts_of(map.narrowest, map.formats.size());
}

}  // namespace

double RequirementMap::min_time(const std::vector<Candidate>& candidates) const {
    double sum = 0;
    std::uint64_t count = 0;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        sum += static_cast<double>(cheapest_pixel_counts[c]) * candidates[c].time.median;
        count += cheapest_pixel_counts[c];
    }
    return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(count);
}

RequirementMap make_requirement_map(const ChoiceRequest& request, const std::vector<Candidate>& candidates,
                                    const PassingPixelsByForm& passing_pixels) {
    RequirementMap map{.width = request.scene->width, .height = request.scene->height};

    std::vector<RankedForm> ranked;
    for (const std::size_t c : order_by_price(candidates))
        ranked.push_back({&passing_pixels.rows[c], static_cast<int>(c)});
    for (std::size_t i = 0; i < request.scene->pixel_count(); ++i) map.cheapest.push_back(first_at(ranked, i));
    map.cheapest_pixel_counts = counts_of(map.cheapest, candidates.size());
    for (const PassingPixels& row : passing_pixels.rows) map.met_pixel_counts.push_back(row.count());

    PassingPixelsByForm emulated(request, request.untimed_forms);
    if (!request.untimed_forms.empty()) {
        evaluate::MapStudy study{
            .scene = request.scene, .tested_forms = request.untimed_forms, .metrics = request.requirement.metrics()};
        study.limit = request.limit;
        study.progress = request.progress;
        (void)evaluate::run_map(study, emulated.show());
    }

    // Any of the forms counts for the narrowest format, timed or not.
    std::vector<TestedForm> tested_forms = request.tested_forms;
    tested_forms.insert(tested_forms.end(), request.untimed_forms.begin(), request.untimed_forms.end());
    std::vector<const PassingPixels*> all_met_pixels;
    for (const PassingPixels& row : passing_pixels.rows) all_met_pixels.push_back(&row);
    for (const PassingPixels& row : emulated.rows) all_met_pixels.push_back(&row);
    find_narrowest(map, tested_forms, all_met_pixels);

    map.unmet_pixel_count = static_cast<std::uint64_t>(std::ranges::count(map.narrowest, RequirementMap::none));
    map.unknown_pixel_count = static_cast<std::uint64_t>(std::ranges::count(map.narrowest, RequirementMap::unresolved));
    return map;
}

}  // namespace lostbits::measure::choose
