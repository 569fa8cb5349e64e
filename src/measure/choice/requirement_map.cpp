#include "measure/choice/requirement_map.hpp"

#include "measure/evaluate/map.hpp"

#include <algorithm>
#include <limits>

namespace lostbits::measure::choice {

using answer::Outcome;
using evaluate::TestedForm;

void MetPixels::band(const evaluate::BandResult& result) {
    const std::size_t first = static_cast<std::size_t>(result.y0) * static_cast<std::size_t>(result.width);
    const std::vector<double>& lost = result.metrics.front();
    // A form that answers no t has no lost bits; NaN counts as no bits kept.
    const auto keeps = [&](std::size_t i) {
        return precision_ - lost[i] >= requirement_.bits &&
               (!requirement_.has_tolerance() || result.metrics[1][i] <= requirement_.tolerance);
    };
    for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
        const Outcome outcome = result.outcomes[i];
        meets_[first + i] = outcome == Outcome::agree_miss || (outcome == Outcome::agree_hit && keeps(i));
        unresolved_[first + i] = outcome == Outcome::unresolved;
    }
}

std::uint64_t MetPixels::count() const { return static_cast<std::uint64_t>(std::ranges::count(meets_, true)); }

MetPixelsByForm::MetPixelsByForm(const ChoiceRequest& request, const std::vector<TestedForm>& of) {
    for (const TestedForm& row : of)
        rows.emplace_back(request.scene->pixels(), request.requirement, row.format.parameters.precision);
}

namespace {

/// A row with its index, in the order in which rows are tried.
struct RankedForm {
    const MetPixels* meets;
    int place;  ///< index of the candidate or of the format
};

/// Index of the first row that meets the requirement at the pixel.
int first_at(const std::vector<RankedForm>& tried, std::size_t pixel) {
    for (const RankedForm& t : tried) {
        if (t.meets->meets(pixel)) return t.place;
    }
    const bool unknown =
        std::ranges::any_of(tried, [pixel](const RankedForm& t) { return t.meets->unresolved(pixel); });
    return unknown ? RequirementMap::unresolved : RequirementMap::none;
}

/// Formats of the rows, each once, ordered by precision and then by name.
std::vector<Format> formats_of(const std::vector<TestedForm>& rows) {
    std::vector<Format> formats;
    for (const TestedForm& row : rows) {
        const Format format = computes_in(row);
        if (std::ranges::find(formats, format) == formats.end()) formats.push_back(format);
    }
    std::ranges::sort(formats, [](const Format& a, const Format& b) {
        return a.parameters.precision != b.parameters.precision ? a.parameters.precision < b.parameters.precision
                                                                : a.name < b.name;
    });
    return formats;
}

/// Counts the indices that are at least 0.
std::vector<std::uint64_t> counts_of(const std::vector<int>& places, std::size_t kinds) {
    std::vector<std::uint64_t> counts(kinds);
    for (const int place : places) {
        if (place >= 0) ++counts[static_cast<std::size_t>(place)];
    }
    return counts;
}

/// Fills in the members about formats; `meetings` belong to `rows`.
void find_narrowest(RequirementMap& r, const std::vector<TestedForm>& rows,
                    const std::vector<const MetPixels*>& meetings) {
    r.formats = formats_of(rows);
    std::vector<std::vector<RankedForm>> of_format(r.formats.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const auto place = std::ranges::find(r.formats, computes_in(rows[k])) - r.formats.begin();
        of_format[static_cast<std::size_t>(place)].push_back({meetings[k], static_cast<int>(place)});
    }
    r.any_meets.assign(r.formats.size(), 0);
    for (std::size_t i = 0; i < r.pixels(); ++i) {
        int narrowest = RequirementMap::none;
        for (std::size_t f = 0; f < of_format.size(); ++f) {
            const int found = first_at(of_format[f], i);
            if (found >= 0) ++r.any_meets[f];
            if (narrowest < 0 && found != RequirementMap::none) narrowest = found;
        }
        r.narrowest.push_back(narrowest);
    }
    r.needed = counts_of(r.narrowest, r.formats.size());
}

}  // namespace

double RequirementMap::least_time(const std::vector<Candidate>& all) const {
    double sum = 0;
    std::uint64_t count = 0;
    for (std::size_t c = 0; c < all.size(); ++c) {
        sum += static_cast<double>(taken[c]) * all[c].time.median;
        count += taken[c];
    }
    return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(count);
}

RequirementMap requirement_map_of(const ChoiceRequest& request, const std::vector<Candidate>& all,
                                  const MetPixelsByForm& meetings) {
    RequirementMap r{.width = request.scene->width, .height = request.scene->height};
    std::vector<RankedForm> tried;
    for (const std::size_t c : by_price(all)) tried.push_back({&meetings.rows[c], static_cast<int>(c)});
    for (std::size_t i = 0; i < request.scene->pixels(); ++i) r.cheapest.push_back(first_at(tried, i));
    r.taken = counts_of(r.cheapest, all.size());
    for (const MetPixels& row : meetings.rows) r.met.push_back(row.count());

    MetPixelsByForm emulated(request, request.untimed);
    if (!request.untimed.empty()) {
        evaluate::MapStudy asked{
            .scene = request.scene, .rows = request.untimed, .metrics = request.requirement.metrics()};
        asked.limit = request.limit;
        asked.progress = request.progress;
        (void)evaluate::run_map(asked, emulated.show());
    }
    std::vector<TestedForm> rows = request.rows;
    rows.insert(rows.end(), request.untimed.begin(), request.untimed.end());
    std::vector<const MetPixels*> of_all;
    for (const MetPixels& row : meetings.rows) of_all.push_back(&row);
    for (const MetPixels& row : emulated.rows) of_all.push_back(&row);
    find_narrowest(r, rows, of_all);
    r.none_meets = static_cast<std::uint64_t>(std::ranges::count(r.narrowest, RequirementMap::none));
    r.unknown = static_cast<std::uint64_t>(std::ranges::count(r.narrowest, RequirementMap::unresolved));
    return r;
}

}  // namespace lostbits::measure::choice
