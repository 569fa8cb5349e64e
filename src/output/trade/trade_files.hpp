// Files of a trade: trade.csv (time), pareto.csv (time against accuracy), a scatter plot per set of rays, trade.txt
// (the answer in words) and datapackage.json. Times are measured, so these files differ from run to run; their columns
// of accuracy and of operations do not. Also holds what all tables and pictures of time against accuracy share: the
// columns that name a kernel, and the points. A kernel is a form in a format, compiled for one register width.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measure/trade/trade.hpp"
#include "output/plot/scatter_plot.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::trade {

using measure::trade::ParetoPoint;
using measure::trade::Timing;
using measure::trade::TradeRequest;
using measure::trade::TradeResult;

/// Cells that name a kernel in tables. `isa` is its register width in bits, or `scalar`.
struct KernelKey {
    std::string_view form, format, isa;
};
/// The columns form, format and isa. `meaning_of_form` is the meaning of the first one.
table::Table<KernelKey> kernel_columns(const std::string& meaning_of_form);

/// The columns time_ns, time_ns_q1 and time_ns_q3. `median_meaning` is the meaning of the first one, and
/// `quartile_prefix` precedes the meanings of the other two.
table::Table<Timing> time_columns(const std::string& median_meaning, const std::string& quartile_prefix = "");

/// A kernel in the plane of time and kept bits.
struct KernelPoint {
    const measure::evaluate::TestedForm& tested_form;
    ParetoPoint quality;
    std::optional<Timing> time;  ///< missing: the time has no quartiles
    int marker = 0;
    bool is_named = false;   ///< the point has a label even if it is not on the Pareto front
    bool is_hollow = false;  ///< the kernel decides too many rays wrongly
    std::string label = {};  ///< replaces the form's name
};

/// Adds points with the quartiles of their times to a plot. The colour of a point shows the format. Points that are
/// neither on the Pareto front nor named are grey. A stepped line joins the points on the front; it is dashed after a
/// point that is sometimes wrong.
void add_kernel_points(plot::ScatterPlotSpec& spec, const std::vector<KernelPoint>& points);
/// Palette index of the colour of points in a format.
std::size_t colour_of(const Format& format);

/// A row of trade.csv: the time of a kernel under one load.
struct TimeRow {
    KernelKey kernel;
    const measure::trade::TradeLoad* load;
    const measure::trade::TradeResult::KernelTime* timed;
    int repetitions;
    const OperationCounts* operations;
};
/// A row of pareto.csv: the accuracy of a kernel on a set of rays, and its time.
struct ParetoRow {
    std::string ray_set;
    KernelKey kernel;
    ParetoPoint quality;
    const measure::evaluate::FormSummary* accuracy;
    const measure::metric::Distribution *lost_bits, *excess_bits;
    bool is_dominated;
};

[[nodiscard]] table::Table<TimeRow> make_time_table();
[[nodiscard]] std::vector<TimeRow> make_time_rows(const TradeRequest& request, const TradeResult& result);
[[nodiscard]] table::Table<ParetoRow> make_pareto_table();
[[nodiscard]] std::vector<ParetoRow> make_pareto_rows(const TradeRequest& request, const TradeResult& result);

/// Files of a trade. They are opened before the work and get their final names when they are complete.
class TradeWriter {
public:
    TradeWriter(const TradeRequest& request, const std::filesystem::path& folder);
    void finish(const TradeResult& result);

private:
    const TradeRequest& request_;
    std::filesystem::path folder_;
    table::TableFile<TimeRow> times_;
    table::TableFile<ParetoRow> pareto_;
};

/// Accuracy of every kernel on a set of rays, with its time under the reference load.
std::vector<ParetoPoint> pareto_points(const TradeRequest& request, const TradeResult& result, std::size_t set_index);

/// Lists for each set of rays the forms by time, and the cheapest form that keeps each number of bits. The last
/// sentence says how the times were measured.
std::string trade_text(const TradeRequest& request, const TradeResult& result);

/// Titles of the axes of the plot, also on the page of `lostbits report`.
inline constexpr const char *time_title = "time per ray of the easy set, ns",
                            *scene_time_title = "time per ray and primitive on the scene, ns",
                            *kept_title = "bits that 99 % of the hits keep";

/// Register width of a kernel: `one ray at a time`, `256-bit registers`.
std::string register_text(const measure::trade::TradeKernel& kernel);

/// Plot of a trade: markers by register width, colours by format. Dominated kernels are grey, and kernels that decide
/// any ray wrongly are hollow. A stepped line joins the kernels that are not dominated; the line is dashed after a
/// kernel that is sometimes wrong.
plot::ScatterPlotSpec make_trade_plot(const TradeRequest& request, const TradeResult& result, std::size_t set_index);

}  // namespace lostbits::output::trade
