// Offsets over a picture: at every point where a form meets what the ray truly meets first, the smallest safe offset,
// and every strategy against it.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measure/metric/measured_column.hpp"
#include "measure/metric/statistics.hpp"
#include "measure/offset/at_point.hpp"

namespace lostbits::measure::offset {

inline constexpr std::array<std::string_view, 2> point_names{"computed", "projected"};
inline constexpr std::string_view name_of(HitPoint p) { return point_names[static_cast<std::size_t>(p)]; }

/// A respawned ray that shows what is wrong, with everything it takes to ask again.
struct BadRay {
    int x = -1, y = -1;
    int object = -1;
    NewRay ray{};
    Solid<double> solid{};
};

/// One strategy to one side, over all points.
struct StrategySummary {
    std::array<std::uint64_t, fault_names.size()> count{};             ///< of rays
    std::array<std::optional<BadRay>, fault_names.size()> first = {};  ///< in the order of the pixels
    std::uint64_t bad = 0;          ///< rays with a fault but `wrong_side`, which alone harms nothing
    metric::Distribution size;      ///< largest |new origin − p| of each point
    metric::Distribution oversize;  ///< that over the smallest safe offset, where this is finite and not 0
    std::uint64_t too_small = 0;    ///< points of those with less than the smallest safe offset

    [[nodiscard]] std::uint64_t operator[](Fault f) const { return count[static_cast<std::size_t>(f)]; }
    [[nodiscard]] const std::optional<BadRay>& first_with(Fault f) const { return first[static_cast<std::size_t>(f)]; }
};

/// One side of all points of a row.
struct SideSummary {
    std::uint64_t rays = 0;
    std::uint64_t already_safe = 0;  ///< points that need no offset at all
    std::uint64_t never_safe = 0;    ///< points that no offset along the normal makes safe
    std::uint64_t never_quiet = 0;   ///< the same where the form's arithmetic counts as well
    metric::Distribution safe;       ///< smallest safe offset of the points that have one, 0 among them; world units
    metric::Distribution safe_ulps;  ///< the same in ulps of max |p|
    metric::Distribution quiet;      ///< smallest offset that is safe and in which the form finds no self-hit
    std::vector<StrategySummary> strategies;
};

/// A form in a format, and how its points are taken.
struct OffsetRow {
    evaluate::TestedForm row;
    HitPoint point = HitPoint::computed;
    friend bool operator==(const OffsetRow&, const OffsetRow&) = default;
};

struct OffsetSummary {
    std::uint64_t pixels = 0;
    /// Pixels where the form answers the solid that the ray truly meets first, beyond its origin, and the computed
    /// point is finite: all that follows is about these.
    std::uint64_t points = 0;
    std::uint64_t unresolved = 0;  ///< pixels whose truth is not proved
    std::array<SideSummary, 2> sides;

    [[nodiscard]] const SideSummary& on(Side side) const { return sides[static_cast<std::size_t>(side)]; }
};

/// What a row is over some scanlines: pixel by pixel, and, where `is_point` of the pixel, its two sides and the
/// strategies, those to the outside first.
struct OffsetBand {
    int y0 = 0, rows = 0, width = 0;
    std::vector<std::uint8_t> is_point;
    std::vector<std::int32_t> object;  ///< −1 where there is no point
    std::vector<double> ulp;           ///< of max |p|
    std::vector<std::array<SideOfPoint, 2>> sides;
    std::vector<StrategyAtPoint> by_strategy;
    std::size_t strategies = 0;

    [[nodiscard]] const StrategyAtPoint& at(std::size_t pixel, Side side, std::size_t strategy) const {
        return by_strategy[(2 * pixel + static_cast<std::size_t>(side)) * strategies + strategy];
    }
};

struct OffsetRequest {
    const scene::file::Scene& scene;
    std::vector<OffsetRow> rows;  ///< of forms of primitives that tell t
    std::vector<const Strategy*> strategies;
    truth::TruthLimit limit{};
    bool quiet = true;  ///< also look for the smallest quiet offset, which takes as long as all the rest
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};  ///< after each band of a row: its pixels
};

/// The forms that points and self-hits are measured by where none is named, one a shape in the order of the shapes, and
/// their format.
const std::vector<std::string_view>& usual_forms();
inline constexpr std::string_view usual_format = "f32";

/// More solids than these are too many to hold each point against all of them.
inline constexpr std::size_t most_solids = 1000;
/// InputError for a scene that this cannot be asked of, which is named.
void require_few_solids(const scene::file::Scene& scene);
/// Whether a form can be asked: of a primitive, and it tells t.
bool can_be_asked(const intersect::table::Intersector& form);

/// One summary a row. `show` gets the bands of each row from top to bottom, one at a time. The results do not depend on
/// the number of threads.
std::vector<OffsetSummary> run_offsets(const OffsetRequest& request,
                                       const std::function<void(std::size_t row, const OffsetBand& band)>& show = {});

/// A column of the summary after point, side, strategy, form and format; the CSV and the claims read the same rows.
using OffsetColumn = metric::MeasuredColumn<const OffsetSummary&, Side, std::size_t>;
std::span<const OffsetColumn> offset_columns();

/// A strategy with which no respawned ray goes wrong.
struct SafeStrategy {
    const Strategy* strategy;
    /// What one new ray costs, in operations as the rule is written (`Strategy::operations`): a count, not a time.
    std::uint64_t operations;
    double oversize;  ///< how many times larger than needed, the median over the sides; NaN where nothing is needed
};

/// Those of a measured row to all of these sides, the cheapest first; of equally cheap ones in the order of the table.
/// Safe is `StrategySummary::bad` = 0: no self-hit by truth or by the form, no occluder and no way out lost. Empty
/// where none is, and where there is no point.
std::vector<SafeStrategy> safe_strategies(const OffsetSummary& summary, const std::vector<const Strategy*>& strategies,
                                          Shape shape, std::span<const Side> sides = both_sides);

}  // namespace lostbits::measure::offset
