#include "measure/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "commands.hpp"
#include "output/sweep_files.hpp"
#include "output/sweep_plots.hpp"
#include "select.hpp"
#include "signals.hpp"

namespace lostbits::analysis {
namespace {

struct SweepOptions {
    std::vector<std::string> sweeps;
    std::vector<std::string> forms{"*"};
    std::vector<std::string> formats{"f32", "f64"};
    std::vector<std::string> metrics;
    std::string out;
};

void print_onsets(const SweepRequest& request, const std::vector<Onset>& onsets) {
    fmt::print("  {:<28} {:<5} {:<13} {:<5} {:>9} {:>14} {:>14}\n", "form", "fmt", "event", "stat", "threshold", "last good", "first bad");
    for (const Onset& o : onsets) {
        if (!o.found) continue;
        const MapRow& row = request.rows[o.row];
        fmt::print("  {:<28} {:<5} {:<13} {:<5} {:>9} {:>14.8g} {:>14.8g}\n", row.form->info->name, row.format.name, o.event, o.statistic, o.threshold, o.last_good,
                   o.first_bad);
    }
}

Exit run(const SweepOptions& o, const Common& common) {
    const auto rows = cross(select_forms(o.forms), select_formats(o.formats));
    // A sweep always knows what the problem itself costs: its plots carry the envelope.
    auto asked = o.metrics.empty() ? std::vector<const Metric*>{} : select_metrics(o.metrics);
    for (const char* name : {"inherent_bits", "excess_bits"}) asked.push_back(find_metric(name));
    const auto chosen = measured(asked);
    if (o.out.empty()) throw InputError("-o: the name of the folder is empty; write -o . for this one");
    const auto data = data_folder(common.data);
    std::vector<scene::SweepFile> sweeps;
    for (const std::string& word : o.sweeps) sweeps.emplace_back(scene::find_sweep(word, data), data);
    const ThreadLimit limit(common.threads);

    output::ImageBackend& backend = output::image_backend();
    for (const scene::SweepFile& sweep : sweeps) {
        SweepRequest request{.sweep = &sweep, .rows = rows, .metrics = chosen};
        const auto folder = std::filesystem::path(o.out) / sweep.id;
        output::SweepFiles files(request, folder);
        output::Progress progress(sweep_units(request), sweep.id, common.progress, common.quiet);
        request.progress = [&progress](std::uint64_t done) {
            progress.advance(done);
            stop_if_interrupted();
        };
        const auto steps = run_sweep(request);
        const auto onsets = find_onsets(request, steps);
        output::write_sweep_plots(backend, folder, request, steps);
        files.finish(steps, onsets);
        progress.finish();
        if (common.quiet) continue;
        fmt::print("{}\n", (folder / "samples.csv").string());
        if (common.verbose) print_onsets(request, onsets);
    }
    return Exit::done;
}

}  // namespace

void add_sweep(CLI::App& program, const Common& common, Command& chosen) {
    auto* command = program.add_subcommand("sweep", "Errors along a parameter, and where they first cross a threshold");
    const auto o = std::make_shared<SweepOptions>();
    command->add_option("SWEEP", o->sweeps, "Sweep files, or names in data/sweeps")->required();
    command->add_option("-i,--intersector", o->forms, "Forms, by name or glob (default: all)");
    command->add_option("-f,--format", o->formats, "Formats: f32, f64, fp16, bf16, tf32, pN, pA..pB (default: f32 f64)");
    command->add_option("--metric", o->metrics, "Metrics beside the default ones; globs");
    command->add_option("-o,--out", o->out, "Folder for the results")->required();
    command->callback([o, &common, &chosen] { chosen = [o, &common] { return run(*o, common); }; });
}

}  // namespace lostbits::analysis
