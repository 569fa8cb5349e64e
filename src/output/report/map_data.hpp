// Pixels of a map as the page holds them: the CSV's data of every ray in a few bytes each. Also the rays whose
// operations the page holds, as `lostbits explain` lists them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "measure/evaluate/map.hpp"
#include "output/report/pack.hpp"
#include "output/report/text.hpp"

namespace lostbits::output::report {

using measure::evaluate::FormSummary;
using measure::evaluate::MapStudy;
using measure::evaluate::TestedForm;

/// A pixel whose operations the page holds. `reasons` says why it was chosen: `median error`, or the name of an
/// outcome.
struct ChosenRay {
    int x, y;
    std::vector<std::string> reasons;
};

/// A picture is cut into this many parts in each direction, and the worst ray of each part is chosen.
inline constexpr std::size_t parts_each_way = 4;

/// Chooses rays, each at most once: the worst ray, the first of each kind of wrong decision, the largest and the median
/// error, and the worst of each part of the picture. `error_sizes` has one value per pixel: |ulp_error| of a correct
/// hit, infinity for a wrong decision, NaN without an error.
[[nodiscard]] std::vector<ChosenRay> choose_rays(const FormSummary& summary, std::span<const float> error_sizes,
                                                 int width);

/// The output of `explain` for each ray: its sentences, and its table with a row per operation. A compiled form has no
/// operations.
[[nodiscard]] Json rays_json(const MapStudy& study, const TestedForm& tested_form, const std::vector<ChosenRay>& rays);

/// A packed piece of data, and the name by which the page finds it.
struct NamedData {
    std::string name, packed;
};

/// Collects the results of a map row by row. It keeps exactly
/// - once for all rows with the same truth (by direction and convention): the true decision; the double T nearest to
/// t*,
///   as its difference from the value that the two hits to the left predict linearly; the remainder t* − T as a float;
///   the bound as a power of two; and κ as a float;
/// - for each row: the outcome, the primitive, and the bits of t minus those of the truth, both in the row's format
///   (most answers are a few ulps away, so most differences are small);
/// - every other metric as a float;
/// - the output of `lostbits explain` for the rays of `choose_rays`.
/// The page itself computes the metrics that are functions of t and t* alone (`derived_metrics`).
class MapData {
public:
    explicit MapData(const MapStudy& study);
    ~MapData();
    MapData(const MapData&) = delete;
    MapData& operator=(const MapData&) = delete;

    /// Returns a function that receives the bands of the study's rows.
    [[nodiscard]] measure::evaluate::ShowForms band_receiver();

    /// All data except the pixels; call this after the map. `has_scene_size`: the map has the scene's own size, so that
    /// claims are about the same rays. `scene_with_size`: the scene with its size, as a command names it.
    [[nodiscard]] Json index(const std::vector<FormSummary>& summaries, bool has_scene_size,
                             const std::string& scene_with_size) const;
    /// The pixels and the operations of the chosen rays; call this after the map.
    [[nodiscard]] std::vector<NamedData> named_data(const std::vector<FormSummary>& summaries) const;

private:
    struct Group;
    class Row;
    const MapStudy& study_;
    std::vector<std::unique_ptr<Group>> groups_;
    std::vector<std::unique_ptr<Row>> rows_;
};

}  // namespace lostbits::output::report
