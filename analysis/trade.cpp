#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "analysis/choice/options.hpp"
#include "analysis/choice/select.hpp"
#include "commands.hpp"
#include "measure/speed/trade.hpp"
#include "output/speed/trade_files.hpp"

namespace lostbits::analysis {
namespace {

struct TradeOptions {
    std::string shape = "sphere";
    std::vector<std::string> forms{"*"};
    std::vector<std::string> formats{"f32", "f64"};
    std::string out;
    int repetitions = 0;  ///< 0: the plan's own
    bool quick = false;
};

std::vector<Format> native_formats(const std::vector<std::string>& names) {
    const auto formats = choice::select_formats(names);
    for (const Format& f : formats) {
        if (f.engine == Format::Engine::rounded)
            throw InputError(fmt::format(
                "-f {}: this format is emulated, so its time says nothing; only f32 and f64 are timed", f.name));
    }
    return formats;
}

measure::speed::TimingPlan plan_of(const TradeOptions& o) {
    measure::speed::TimingPlan plan;
    if (o.quick) {
        plan.repetitions = 5;
        plan.least_seconds = 1e-4;
    }
    if (o.repetitions > 0) plan.repetitions = o.repetitions;
    return plan;
}

Exit run(const TradeOptions& o, const Common& common) {
    require_folder(o.out);
    const Shape shape = o.shape == "box" ? Shape::box : Shape::sphere;
    const auto rows = choice::fitting(choice::cross(choice::select_forms(o.forms), native_formats(o.formats)),
                                      [shape](Shape form) { return form == shape; });
    if (rows.empty())
        throw NothingSelected(fmt::format(
            "--shape {0}: none of the selected forms is for a {0}; try -i '{0}.*' or another --shape", o.shape));
    measure::speed::TradeRequest request{.shape = shape,
                                         .kernels = measure::speed::trade_kernels(rows),
                                         .metrics = {},
                                         .loads = measure::speed::trade_loads(measure::speed::cache_sizes()),
                                         .plan = plan_of(o)};
    for (const char* name : {"lost_bits", "excess_bits"}) request.metrics.push_back(measure::metric::find_metric(name));
    const auto folder = std::filesystem::path(o.out) / o.shape;
    const auto owner = own_folder(folder, common, "");
    output::speed::TradeFiles files(request, folder);
    const choice::ThreadLimit limit(common.threads);
    output::file::Progress progress(measure::speed::trade_units(request), fmt::format("trade {}", o.shape),
                                    common.progress, common.quiet);
    request.plan.progress = advancing(progress);
    const measure::speed::TradeResult result = measure::speed::run_trade(request);
    files.finish(result);
    progress.finish();
    if (!common.quiet)
        fmt::print("{}\n{}\n", output::speed::trade_in_words(request, result), (folder / "pareto.csv").string());
    return Exit::done;
}

}  // namespace

void add_trade(CLI::App& program, const Common& common, Command& chosen) {
    auto* command = program.add_subcommand("trade", "Measured speed against measured accuracy, with the Pareto front");
    const auto o = std::make_shared<TradeOptions>();
    command->add_option("--shape", o->shape, "sphere (default) or box")->check(CLI::IsMember({"sphere", "box"}));
    choice::add_list(*command, "-i,--intersector", o->forms, "Forms, by name or glob (default: all of the shape)");
    choice::add_list(*command, "-f,--format", o->formats, "f32, f64 (default: both)");
    command->add_option("--repetitions", o->repetitions, "Measurements of each kernel (default: 25; 5 with --quick)")
        ->check(CLI::Range(1, 1000));
    command->add_flag("--quick", o->quick, "Shorter measurements, for a first look");
    command->add_option("-o,--out", o->out, "Folder for the results")->required();
    command->callback([o, &common, &chosen] { chosen = [o, &common] { return run(*o, common); }; });
}

}  // namespace lostbits::analysis
