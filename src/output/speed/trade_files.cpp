#include "output/speed/trade_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "output/file/datapackage.hpp"
#include "output/speed/kernel_rows.hpp"
#include "output/speed/trade_plot.hpp"

namespace lostbits::output::speed {

using file::Cell;
using file::Column;
using file::number_or_missing;
using measure::answer::Outcome;
using measure::speed::TradeRequest;
using measure::speed::TradeResult;

namespace {

constexpr const char* form_meaning = "form under test; with +contract or +fastmath, compiled with those flags";

std::vector<Column> time_columns() {
    std::vector<Column> columns = kernel_columns(form_meaning);
    columns.insert(
        columns.end(),
        {{"working_set", "string", "",
          "where rays and answers lie: l1, l2 (half of the cache), memory (read again and again); scene: rays of the "
          "scene, taken evenly over its picture"},
         {"working_set_bytes", "integer", "B", "of rays and answers"},
         {"working_set_rays", "integer", "", "rays that these bytes hold"},
         {"hit_rate", "number", "1",
          "share of the rays that hit; in l1 a processor can learn the few hundred rays, so kernels that "
          "branch look faster than they are"},
         {"time_ns", "number", "ns",
          "per ray, of a scene per ray and solid; median of the repetitions, as are the quartiles"},
         {"time_ns_q1", "number", "ns", "first quartile"},
         {"time_ns_q3", "number", "ns", "third quartile"},
         {"spread", "number", "1", "(third - first quartile)/median"},
         {"rays_per_second", "number", "1/s", "1/time"},
         {"repetitions", "integer", "", "measurements, one in each round over all kernels"}});
    for (const auto name : operation_names) {
        columns.push_back({fmt::format("ops_{}", name), "integer", "",
                           fmt::format("{} of one evaluation of the form on a hit, as it is written, constants folded",
                                       name == "add"      ? "additions and subtractions"
                                       : name == "choose" ? "selects, minima and maxima"
                                       : name == "sign"   ? "changes of sign, absolute values and copied signs"
                                                          : std::string(name) + " operations")});
    }
    return columns;
}

std::vector<Column> standing_columns() {
    std::vector<Column> columns{{"ray_set", "string", "", "rays that accuracy is measured on"}};
    const auto kernel = kernel_columns(form_meaning);
    columns.insert(columns.end(), kernel.begin(), kernel.end());
    columns.insert(
        columns.end(),
        {{"time_ns", "number", "ns",
          "per ray of the easy set, working set l1, hit rate 0.5; of a scene, per ray of its own and solid: median"},
         {"rays", "integer", "", "rays of the set"},
         {"lost_bits_p50", "number", "bits", "median over the correct hits"},
         {"lost_bits_p99", "number", "bits", "99th percentile over the same"},
         {"excess_bits_p99", "number", "bits", "99th percentile of what is lost beyond what the problem itself costs"},
         {"kept_bits_p99", "number", "bits", "significand bits of the format minus lost_bits_p99"},
         {"false_hit_fraction", "number", "1", "false hits among the rays that truly miss"},
         {"false_miss_fraction", "number", "1", "false misses among the rays that truly hit"},
         {"wrong_fraction", "number", "1",
          "false hits, false misses, NaNs and, of a scene, hits of another solid, among all rays whose truth is known"},
         {"dominated", "boolean", "",
          "whether another entry of the set is at least as fast and at least as accurate, and better in one of the "
          "two; the more accurate entry has the smaller wrong_fraction or, if these are equal, the greater "
          "kept_bits_p99"}});
    return columns;
}

Cell fraction(std::uint64_t part, std::uint64_t whole) {
    return number_or_missing(measure::truth::fraction(part, whole));
}

const measure::metric::Distribution& metric_of(const TradeRequest& request, const measure::map::MapSummary& s,
                                               const char* name) {
    return s.metrics[measure::metric::place_of(request.metrics, name)];
}

/// Whose time it is.
std::string timed_in_words(const TradeRequest& request, const TradeResult& result) {
    if (!request.scene)
        return "Time per ray of the easy set, working set l1, every other ray a hit. Measured in this run, so it "
               "varies.\n";
    const auto& timed = result.times.front().front();
    return fmt::format(
        "Time per ray and solid: {} rays of the scene against {} of its solids. Measured in this run, "
        "so it varies.\n",
        timed.rays, timed.solids);
}

std::string in_words(const measure::speed::TradeKernel& kernel) {
    const std::string width = kernel.isa == "scalar" ? "one ray at a time" : fmt::format("at {} bits", kernel.isa);
    return fmt::format("{} in {} {}", kernel.measured.form->info->name, kernel.measured.format.name, width);
}

}  // namespace

std::vector<measure::speed::ParetoPoint> pareto_points_of(const TradeRequest& request, const TradeResult& result,
                                                          std::size_t set) {
    std::vector<measure::speed::ParetoPoint> all;
    const std::size_t load = measure::speed::standing_load(request.loads);
    for (std::size_t k = 0; k < request.kernels.size(); ++k) {
        all.push_back(measure::speed::pareto_point(result.times[k][load].timing, request.kernels[k].measured,
                                                   result.accuracy(set, k), request.metrics));
    }
    return all;
}

std::string trade_in_words(const TradeRequest& request, const TradeResult& result) {
    std::string text = timed_in_words(request, result);
    const auto sets = measure::speed::trade_sets(request);
    for (std::size_t s = 0; s < sets.size(); ++s) {
        const auto all = pareto_points_of(request, result, s);
        text += fmt::format("\n{}: {}\n", sets[s].name, sets[s].title);
        for (const int bits : measure::speed::asked_bits) {
            const auto best = measure::speed::cheapest(all, bits);
            const std::string answer =
                best ? fmt::format("is {}: {:.2f} ns", in_words(request.kernels[*best]), all[*best].time_ns)
                     : "does not exist: none keeps that many";
            text += fmt::format(
                "  the cheapest form that keeps at least {:>2} bits (p99) on this set with no wrong decision {}\n",
                bits, answer);
        }
    }
    return text;
}

TradeFiles::TradeFiles(const TradeRequest& request, const std::filesystem::path& folder)
    : request_(request),
      folder_(folder),
      times_(folder / "trade.csv", time_columns()),
      standings_(folder / "pareto.csv", standing_columns()) {}

void TradeFiles::write_times(const TradeResult& result) {
    for (std::size_t k = 0; k < request_.kernels.size(); ++k) {
        for (std::size_t l = 0; l < request_.loads.size(); ++l) {
            const auto& [timing, bytes, rays, hit_rate, solids] = result.times[k][l];
            add_kernel(times_, request_.kernels[k].measured, request_.kernels[k].isa);
            times_.add(request_.loads[l].working_set).add(bytes).add(rays).add(hit_rate);
            times_.add(timing.median * 1e9).add(timing.low_quartile * 1e9).add(timing.high_quartile * 1e9);
            times_.add((timing.high_quartile - timing.low_quartile) / timing.median)
                .add(1 / timing.median)
                .add(request_.plan.repetitions);
            for (const std::uint64_t count : result.operations[k].of) times_.add(count);
            times_.end_row();
        }
    }
}

void TradeFiles::write_standings(const TradeResult& result) {
    const auto sets = measure::speed::trade_sets(request_);
    for (std::size_t s = 0; s < sets.size(); ++s) {
        const auto all = pareto_points_of(request_, result, s);
        const auto beaten = measure::speed::dominated(all);
        for (std::size_t k = 0; k < all.size(); ++k) {
            const measure::map::MapSummary& a = result.accuracy(s, k);
            const measure::metric::Distribution& lost = metric_of(request_, a, "lost_bits");
            standings_.add(sets[s].name);
            add_kernel(standings_, request_.kernels[k].measured, request_.kernels[k].isa);
            standings_.add(all[k].time_ns)
                .add(a.rays)
                .add(number_or_missing(lost.quantile(0.5)))
                .add(number_or_missing(lost.quantile(0.99)));
            standings_.add(number_or_missing(metric_of(request_, a, "excess_bits").quantile(0.99)))
                .add(number_or_missing(all[k].kept_bits));
            standings_.add(fraction(a.count(Outcome::false_hit), a.true_misses()));
            standings_.add(fraction(a.count(Outcome::false_miss), a.true_hits))
                .add(all[k].wrong_fraction)
                .add(static_cast<bool>(beaten[k]));
            standings_.end_row();
        }
        write_trade_plot(folder_ / fmt::format("{}.png", sets[s].name), request_, result, s);
    }
}

void TradeFiles::finish(const TradeResult& result) {
    write_times(result);
    write_standings(result);
    file::AtomicFile words(folder_ / "trade.txt");
    words.write(trade_in_words(request_, result));
    words.commit();
    file::write_datapackage(
        folder_ / "datapackage.json",
        request_.scene ? fmt::format("Speed against accuracy on {}", request_.scene->id)
                       : fmt::format("Speed against accuracy of the {} forms",
                                     shape_names[static_cast<std::size_t>(request_.shape)]),
        {{"trade.csv", "One row per form, format, register width, working set and hit rate; times vary from run to run",
          time_columns()},
         {"pareto.csv", "One row per set of rays, form, format and register width; times vary from run to run",
          standing_columns()}});
    times_.close();
    standings_.close();
}

}  // namespace lostbits::output::speed
