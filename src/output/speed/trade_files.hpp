// Files of a trade: trade.csv (time), pareto.csv (time against accuracy), a scatter plot per set of rays, trade.txt
// (the answer in words) and datapackage.json. Times are measured, so these files differ from run to run; their columns
// of accuracy and of operations do not. Also the parts common to all tables and pictures of time against accuracy: the
// columns that name a kernel, and the points.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measure/speed/trade.hpp"
#include "output/plot/scatter_plot.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::speed {

using measure::speed::ParetoPoint;
using measure::speed::Timing;
using measure::speed::TradeRequest;
using measure::speed::TradeResult;

/// Name of a kernel in tables.
struct KernelKey {
    std::string_view form, format, isa;
};
/// The columns form, format and isa. `form` is the meaning of the column form.
table::Table<KernelKey> kernel_columns(const std::string& form);

/// The columns time_ns, time_ns_q1 and time_ns_q3.
table::Table<Timing> time_columns(const std::string& median, const std::string& quartiles_of = "");

/// A kernel in the plane of time and kept bits.
struct FrontPoint {
    const measure::evaluate::TestedForm& row;
    ParetoPoint quality;
    std::optional<Timing> time;  ///< missing: the time has no quartiles
    int marker = 0;
    bool named = false;      ///< named wherever the point lies; points on the front are always named
    bool hollow = false;     ///< the kernel decides too many rays wrongly
    std::string label = {};  ///< replaces the form's name
};

/// Adds points with the quartiles of their times. Points that are neither on the Pareto front nor named are grey, and
/// the colour shows the format. A stepped line joins the front; it is dashed between points that are sometimes wrong.
void add_front(plot::ScatterPlotSpec& spec, const std::vector<FrontPoint>& points);
/// Colour of points in a format.
std::size_t colour_of(const Format& format);

/// Time of a kernel with one of the loads.
struct TimeRow {
    KernelKey name;
    const measure::speed::TradeLoad* load;
    const measure::speed::TradeResult::Timed* timed;
    int repetitions;
    const OperationCounts* operations;
};
/// Accuracy of a kernel on one of the sets of rays, and its time.
struct ParetoRow {
    std::string set;
    KernelKey name;
    ParetoPoint quality;
    const measure::evaluate::FormSummary* accuracy;
    const measure::metric::Distribution *lost, *excess;
    bool dominated;
};

[[nodiscard]] table::Table<TimeRow> time_table();
[[nodiscard]] std::vector<TimeRow> time_rows(const TradeRequest& request, const TradeResult& result);
[[nodiscard]] table::Table<ParetoRow> pareto_table();
[[nodiscard]] std::vector<ParetoRow> pareto_rows(const TradeRequest& request, const TradeResult& result);

/// Files of a trade. They are opened before the work and get their final names when they are complete.
class TradeFiles {
public:
    TradeFiles(const TradeRequest& request, const std::filesystem::path& folder);
    void finish(const TradeResult& result);

private:
    const TradeRequest& request_;
    std::filesystem::path folder_;
    table::TableFile<TimeRow> times_;
    table::TableFile<ParetoRow> pareto_;
};

/// Accuracy of every kernel on a set of rays, with its time under the reference load.
std::vector<ParetoPoint> pareto_points_of(const TradeRequest& request, const TradeResult& result, std::size_t set);

/// Lists for each set of rays the forms by time, and the cheapest form that keeps each number of bits. Ends with how
/// the times were measured.
std::string trade_text(const TradeRequest& request, const TradeResult& result);

/// Titles of the axes of the picture, here and on the page.
inline constexpr const char *time_title = "time per ray of the easy set, ns",
                            *scene_time_title = "time per ray and primitive on the scene, ns",
                            *kept_title = "bits that 99 % of the hits keep";

/// `one ray at a time`, `256-bit registers`
std::string registers_of(const measure::speed::TradeKernel& kernel);

/// Plot of a trade: markers by register width, colours by format. Dominated kernels are grey, and kernels that decide
/// any ray wrongly are hollow. A stepped line joins the kernels that are not dominated; the line is dashed between
/// kernels that are sometimes wrong.
plot::ScatterPlotSpec trade_plot(const TradeRequest& request, const TradeResult& result, std::size_t set);

}  // namespace lostbits::output::speed
