#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "analysis/selection/external.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "analysis/study/measurements.hpp"
#include "commands.hpp"
#include "measure/trade/trade.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/trade/trade_files.hpp"
#include "text/shell_word.hpp"

namespace lostbits::analysis {

using measure::trade::TradeRequest;
using scene::file::Scene;

namespace {

struct TradeOptions {
    std::string shape;  ///< empty: not typed
    std::string scene, size, variant;
    std::vector<std::string> set;
    std::vector<std::string> forms{"*"};
    std::vector<std::string> formats{"f32", "f64"};
    std::string out;
    int repetitions = 0;  ///< 0: as many as the plan has
    bool quick = false;
};

measure::trade::TimingPlan timing_plan(const TradeOptions& options) {
    measure::trade::TimingPlan plan = options.quick ? study::quick_plan() : measure::trade::TimingPlan{};
    if (options.repetitions > 0) plan.repetitions = options.repetitions;
    return plan;
}

ExitStatus run(const TradeOptions& options, const CommonOptions& common) {
    require_folder(options.out);
    auto rows = selection::pair_forms_with_formats(selection::select_forms(options.forms),
                                                   selection::select_formats(options.formats));
    const auto data = selection::data_folder(common.data);
    std::optional<Scene> scene;
    if (!options.scene.empty())
        scene =
            selection::load_one_scene({{options.scene}, options.size, options.variant, options.set, common.stop}, data);
    TradeRequest request =
        study::trade_request(scene ? &*scene : nullptr, options.shape, {rows, options.forms, common.quiet});
    const auto can_test = [&](Shapes forms) { return scene ? scene->accepts(forms) : forms == request.shape; };
    selection::note_unmeasured(options.forms, selection::filter_tested_forms(rows, can_test), common.quiet);

    request.plan = timing_plan(options);
    request.limit.stop = request.plan.stop = common.stop;

    const std::string name = scene ? scene->id : std::string(name_of(request.shape));
    const auto folder = std::filesystem::path(options.out) / name;
    const auto result_folder = lock_folder(folder, common, scene ? text::shell_word(options.scene) : "");
    output::trade::TradeWriter writer(request, folder);
    const selection::ThreadLimit limit(common.threads);
    if (scene && !common.quiet) selection::note_ineffective_settings(options.set, scene->id, rows);
    output::file::Progress progress(measure::trade::count_trade_units(request), fmt::format("trade {}", name),
                                    common.progress, common.quiet);
    request.plan.progress = advance_callback(progress);

    const measure::trade::TradeResult result = measure::trade::run_trade(request);
    writer.finish(result);
    complete_folder(result_folder);
    progress.finish();
    if (!common.quiet)
        fmt::print("{}\n{}\n", output::trade::trade_text(request, result), (folder / "pareto.csv").string());
    return ExitStatus::done;
}

}  // namespace

void add_trade(const shell::Command& program, const CommonOptions& common) {
    auto command = program.add_command("trade", "Measure the speed and the accuracy of forms, with the Pareto front");
    const auto options = std::make_shared<TradeOptions>();
    const std::vector<std::string> primitives(shape_names.begin(), shape_names.begin() + shape_rows.size());
    const auto scene = command.add("SCENE", options->scene,
                                   "Use the rays of this scene: a file or a name in data/scenes (default: none)");
    command
        .add("--shape", options->shape, "Use rays of known kinds at this shape, without a scene (default: sphere)",
             shell::one_of(primitives))
        .excludes(scene);
    command.add("--size", options->size, "Size of the scene's picture, WxH in pixels (default: the scene's)")
        .needs(scene);
    command.add("--variant", options->variant, "One variant of a scene that has several").needs(scene);
    command.add_set(options->set, "Change a number of the scene first: sphere[0].radius=10").needs(scene);

    // Kernels to time, and for how long.
    selection::add_forms(command, options->forms, "all that fit");
    command.add_list("-f,--format", options->formats, "f32, f64 (default: both)");
    command.add("--repetitions", options->repetitions,
                "Number of measurements of each kernel (default: 25; 5 with --quick)",
                shell::whole_number_between(1, 1000));
    command.add("--quick", options->quick, "Measure times briefly, for a first look");
    selection::add_out(command, options->out);
    command.set_action([options, &common] { return run(*options, common); });
}

}  // namespace lostbits::analysis
