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
#include "measure/speed/trade.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/speed/trade_files.hpp"

namespace lostbits::analysis {

using measure::speed::TradeRequest;
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

measure::speed::TimingPlan plan_of(const TradeOptions& o) {
    measure::speed::TimingPlan plan = o.quick ? study::quick_plan() : measure::speed::TimingPlan{};
    if (o.repetitions > 0) plan.repetitions = o.repetitions;
    return plan;
}

Exit run(const TradeOptions& o, const Common& common) {
    require_folder(o.out);
    auto rows = selection::cross(selection::select_forms(o.forms), selection::select_formats(o.formats));
    const auto data = selection::data_folder(common.data);
    std::optional<Scene> scene;
    if (!o.scene.empty()) scene = selection::load_one_scene({{o.scene}, o.size, o.variant, o.set, common.stop}, data);
    TradeRequest request = study::trade_of(scene ? &*scene : nullptr, o.shape, {rows, o.forms, common.quiet});
    const auto fits = [&](Shapes forms) { return scene ? scene->meets(forms) : forms == request.shape; };
    selection::note_unmeasured(o.forms, selection::fitting(rows, fits), common.quiet);
    request.plan = plan_of(o);
    request.limit.stop = request.plan.stop = common.stop;
    const std::string name = scene ? scene->id : std::string(name_of(request.shape));
    const auto folder = std::filesystem::path(o.out) / name;
    const auto result_folder = take_folder(folder, common, scene ? output::attribution::shell_word(o.scene) : "");
    output::speed::TradeFiles files(request, folder);
    const selection::ThreadLimit limit(common.threads);
    if (scene && !common.quiet) selection::note_idle_settings(o.set, scene->id, rows);
    output::file::Progress progress(measure::speed::trade_units(request), fmt::format("trade {}", name),
                                    common.progress, common.quiet);
    request.plan.progress = advance_callback(progress);
    const measure::speed::TradeResult result = measure::speed::run_trade(request);
    files.finish(result);
    complete_folder(result_folder);
    progress.finish();
    if (!common.quiet)
        fmt::print("{}\n{}\n", output::speed::trade_text(request, result), (folder / "pareto.csv").string());
    return Exit::done;
}

}  // namespace

void add_trade(const shell::Command& program, const Common& common) {
    auto command = program.add_command("trade", "Measure the speed and the accuracy of forms, with the Pareto front");
    const auto o = std::make_shared<TradeOptions>();
    const std::vector<std::string> primitives(shape_names.begin(), shape_names.begin() + shape_rows.size());
    const auto scene =
        command.add("SCENE", o->scene, "Use the rays of this scene: a file or a name in data/scenes (default: none)");
    command
        .add("--shape", o->shape, "Use rays of known kinds at this shape, without a scene (default: sphere)",
             shell::one_of(primitives))
        .excludes(scene);
    command.add("--size", o->size, "Size of the scene's picture, WxH in pixels (default: the scene's)").needs(scene);
    command.add("--variant", o->variant, "One variant of a scene that has several").needs(scene);
    command.add_set(o->set, "Change a number of the scene first: sphere[0].radius=10").needs(scene);
    selection::add_forms(command, o->forms, "all that fit");
    command.add_list("-f,--format", o->formats, "f32, f64 (default: both)");
    command.add("--repetitions", o->repetitions, "Number of measurements of each kernel (default: 25; 5 with --quick)",
                shell::whole_from(1, 1000));
    command.add("--quick", o->quick, "Measure times briefly, for a first look");
    selection::add_out(command, o->out);
    command.runs([o, &common] { return run(*o, common); });
}

}  // namespace lostbits::analysis
