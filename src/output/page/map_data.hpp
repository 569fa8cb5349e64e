// The pixels of a map as the page holds them, what the CSV says of every ray in a few bytes each; and the rays whose
// operations it holds, as `lostbits explain` has them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "output/page/pack.hpp"
#include "output/page/text.hpp"

namespace lostbits::output::page {

/// A pixel whose operations are held, and why: words that the page writes as it writes names of outcomes.
struct ChosenRay {
    int x, y;
    std::vector<std::string> why;
};

/// A picture is cut into so many parts each way, and the worst ray of each part is chosen.
inline constexpr std::size_t parts_each_way = 4;

/// The worst ray first, then the first of each kind of wrong decision, the largest and the median error, and the worst
/// of each part of the picture, each once. `sizes`: a pixel each, |ulp_error| of a correct hit, infinity of a wrong
/// decision, NaN of what has no error.
[[nodiscard]] std::vector<ChosenRay> choose_rays(const measure::evaluate::FormSummary& summary,
                                                 std::span<const float> sizes, int width);

/// What `explain` says of each ray: its sentences, and its table a row an operation. Of a form that is compiled
/// elsewhere nothing is known.
[[nodiscard]] Json rays_json(const measure::evaluate::EvaluationRequest& request,
                             const measure::evaluate::TestedForm& row, const std::vector<ChosenRay>& rays);

/// A packed piece of data and the name that the page finds it by.
struct Blob {
    std::string name, packed;
};

/// Takes the results of a map row by row and keeps, exactly,
///  - once for all rows that share a truth (by direction and convention): whether the ray truly hits, RN64(t*) (as its
///  distance from where the two hits to the left point), the rest
///    t* − RN64(t*) as a float, the bound as a power of two, and κ as a float;
///  - for each row: the outcome, the solid, and the bits of t less those of the truth (both as the format holds them):
///    most answers are a few ulps away, so most of these are small;
///  - every other metric as a float;
///  - of `choose_rays` what `lostbits explain` says, operation by operation.
/// What follows from t and t* alone (`derived_metrics`) the page works out itself.
class MapData {
public:
    explicit MapData(const measure::evaluate::EvaluationRequest& request);
    ~MapData();
    MapData(const MapData&) = delete;
    MapData& operator=(const MapData&) = delete;

    /// One per row of the request, in its order.
    [[nodiscard]] std::vector<measure::evaluate::Show> shows();

    /// After the map: everything but pixels. `own_size`: no other size was asked for than the scene's, so that
    /// claims have the same rays. `named`: the scene in its size, as words of a command.
    [[nodiscard]] Json index(const std::vector<measure::evaluate::FormSummary>& summaries, bool own_size,
                             const std::string& named) const;
    /// After the map: the pixels, and the operations of the chosen rays.
    [[nodiscard]] std::vector<Blob> blobs(const std::vector<measure::evaluate::FormSummary>& summaries) const;

private:
    struct Group;
    class Row;
    const measure::evaluate::EvaluationRequest& request_;
    std::vector<std::unique_ptr<Group>> groups_;
    std::vector<std::unique_ptr<Row>> rows_;
};

}  // namespace lostbits::output::page
