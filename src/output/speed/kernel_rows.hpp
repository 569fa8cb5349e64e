// What tables and pictures of time against accuracy have in common: the columns that name a kernel, and the points.
#pragma once

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

}  // namespace lostbits::output::speed
