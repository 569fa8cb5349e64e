// Files of an exhaustive sweep: binades.csv, onsets.csv, statements.csv, pictures and datapackage.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "measure/sweep/exhaustive.hpp"
#include "output/plot/line_plot.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::sweep {

using measure::sweep::ExhaustiveRequest;
using measure::sweep::ExhaustiveState;
using measure::sweep::RangeFinding;

struct FloatsRow;
struct FloatEventRow;

/// Files of an exhaustive sweep. The tables are opened before the work and get their final names in `finish`.
class ExhaustiveWriter {
public:
    ExhaustiveWriter(const ExhaustiveRequest& request, const std::filesystem::path& folder);
    void finish(const ExhaustiveState& state, const std::vector<RangeFinding>& findings);

private:
    void add_binades(const ExhaustiveState& state);
    void add_onsets(const RangeFinding& finding);
    void add_statement(const RangeFinding& finding);

    const ExhaustiveRequest& request_;
    std::filesystem::path folder_;
    table::TableFile<FloatsRow> binades_, statements_;
    table::TableFile<FloatEventRow> onsets_;
};

/// Smallest fraction of a binade above 0: one float of a whole binade. A fraction of 0 is drawn below it.
inline constexpr double smallest_fraction = 0x1p-23;

struct ExhaustivePlots {
    plot::LinePlotSpec lost_bits;  ///< lost bits of the worst float of each binade
    plot::LinePlotSpec wrong;      ///< the fraction of a binade's tried floats with a wrong decision
};
/// Plots with a line for each form, ray and sign. The line is level from the smallest to the largest float of a binade
/// that was tried. Zeros, infinities and NaNs are not on the axis; the tables have them. Nothing if all floats on the
/// axis belong to at most one binade of either sign.
std::optional<ExhaustivePlots> exhaustive_plots(const ExhaustiveRequest& request, const ExhaustiveState& state);

/// `all 8388608 floats between 0x1p+0 (1) and … were tried: sphere.schoolbook decides correctly for every float up to
/// …, and first fails at …: a false miss`. The number of floats was counted.
[[nodiscard]] std::string statement(const ExhaustiveRequest& request, const RangeFinding& finding);

}  // namespace lostbits::output::sweep
