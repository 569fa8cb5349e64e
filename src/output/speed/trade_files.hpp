// The files of a trade: trade.csv (time), pareto.csv (time against accuracy), a scatter plot a set of rays, trade.txt
// (the answer in words) and datapackage.json. Times are measured: of all files of the laboratory these alone differ
// from run to run; their columns of accuracy and of operations do not. And what every table and picture of time against
// accuracy has: the columns that name a kernel, and the points.
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

/// What a kernel is called in tables.
struct KernelName {
    std::string_view form, format, isa;
};
/// form, format and isa; `form` is what the first of them means.
table::Table<KernelName> kernel_columns(const std::string& form);

/// time_ns, time_ns_q1 and time_ns_q3.
table::Table<measure::speed::Timing> time_columns(const std::string& median, const std::string& quartiles_of = "");

/// A kernel in the plane of time and kept bits.
struct FrontPoint {
    const measure::evaluate::TestedForm& row;
    measure::speed::ParetoPoint worth;
    std::optional<measure::speed::Timing> time;  ///< none: what stands for it has no quartiles
    int marker = 0;
    bool named = false;      ///< wherever it lies; those on the front always are
    bool hollow = false;     ///< it decides too many rays wrongly
    std::string label = {};  ///< in place of the form's name
};

/// Points with the quartiles of their times, grey where they are neither on the Pareto front nor named; the colour
/// tells the format. The stepped line joins the front; it is dashed between those that are sometimes wrong.
void add_front(plot::ScatterPlotSpec& spec, const std::vector<FrontPoint>& points);
/// The colour of points in a format.
std::size_t colour_of(const Format& format);

/// A kernel on one of the loads.
struct TimeRow {
    KernelName name;
    const measure::speed::TradeLoad* load;
    const measure::speed::TradeResult::Timed* timed;
    int repetitions;
    const OperationCounts* operations;
};
/// A kernel on one of the sets of rays.
struct StandingRow {
    std::string_view set;
    KernelName name;
    measure::speed::ParetoPoint worth;
    const measure::evaluate::FormSummary* accuracy;
    const measure::metric::Distribution *lost, *excess;
    bool dominated;
};

/// Opened before the work, named when it is whole.
class TradeFiles {
public:
    TradeFiles(const measure::speed::TradeRequest& request, const std::filesystem::path& folder);
    void finish(const measure::speed::TradeResult& result);

private:
    void write_times(const measure::speed::TradeResult& result);
    void write_standings(const measure::speed::TradeResult& result);

    const measure::speed::TradeRequest& request_;
    std::filesystem::path folder_;
    table::TableFile<TimeRow> times_;
    table::TableFile<StandingRow> standings_;
};

/// What every kernel is worth on a set of rays, by its time on the standing load.
std::vector<measure::speed::ParetoPoint> pareto_points_of(const measure::speed::TradeRequest& request,
                                                          const measure::speed::TradeResult& result, std::size_t set);

/// For each set of rays: a table of the forms by time, and the cheapest that keeps each number of bits.
std::string trade_in_words(const measure::speed::TradeRequest& request, const measure::speed::TradeResult& result);

/// The titles of the axes of the picture, here and on the page.
inline constexpr const char *time_title = "time per ray of the easy set, ns",
                            *scene_time_title = "time per ray and solid on the scene, ns",
                            *kept_title = "bits that 99 % of the hits keep";

/// `one ray at a time`, `256-bit registers`
std::string registers_of(const measure::speed::TradeKernel& kernel);

/// What is drawn: markers by register width, colours by format; grey what is dominated, hollow what decides any ray
/// wrongly. The stepped line joins what is not dominated; it is dashed between those that are sometimes wrong.
plot::ScatterPlotSpec trade_plot(const measure::speed::TradeRequest& request, const measure::speed::TradeResult& result,
                                 std::size_t set);
void write_trade_plot(const std::filesystem::path& path, const measure::speed::TradeRequest& request,
                      const measure::speed::TradeResult& result, std::size_t set);

}  // namespace lostbits::output::speed
