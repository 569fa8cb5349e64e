#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "analysis/choice/lost_numbers.hpp"
#include "analysis/choice/options.hpp"
#include "analysis/choice/timed.hpp"
#include "commands.hpp"
#include "output/choice/choice_files.hpp"

namespace lostbits::analysis {

using measure::choice::ChoiceRequest;

namespace {

struct ChooseOptions {
    std::string scene, size, variant, at = "p99", out;
    std::vector<std::string> forms{"*"}, formats{"f32", "f64"}, set;
    double bits = 0, wrong = 0;
    bool single = false, bulk = false, quick = false;
};

double quantile_named(const std::string& text) {
    try {
        return measure::choice::quantile_named(text);
    } catch (const InputError& error) {
        throw InputError(std::string("--at ") + error.what());
    }
}

Exit run(const ChooseOptions& o, const Common& common) {
    require_folder(o.out);
    const auto scene = choice::load_one_scene({{o.scene}, o.size, o.variant, o.set}, choice::data_folder(common.data));
    const auto rows = choice::cross(choice::select_forms(o.forms), choice::select_timed_formats(o.formats));
    ChoiceRequest request{.scene = &scene, .rows = choice::timed_on(scene, rows)};
    request.wish = {.bits = o.bits, .wrong = o.wrong, .quantile = quantile_named(o.at)};
    request.single = o.single;
    if (o.quick) {
        request.plan.repetitions = 5;
        request.plan.least_seconds = 1e-4;
    }
    const auto folder = std::filesystem::path(o.out) / scene.id;
    const auto owner = own_folder(folder, common, choice::name_of_scene(scene, choice::data_folder(common.data)));
    output::choice::ChoiceFiles files(folder);
    const choice::ThreadLimit limit(common.threads);
    const auto work = scene.pixels() * request.rows.size();
    output::file::Progress progress(work, fmt::format("choose {}", scene.id), common.progress, common.quiet);
    request.progress = advancing(progress);
    request.plan.progress = [](std::uint64_t) { stop_if_interrupted(); };
    if (!common.quiet) choice::note_idle_settings(o.set, scene.id, request.rows);
    measure::choice::TimedRays timed;
    const auto all = measure_candidates(request, timed);
    output::choice::Chosen chosen{request, all, timed, cheapest(all, request.wish)};
    request.progress = [](std::uint64_t) { stop_if_interrupted(); };
    if (chosen.meets) chosen.rooms = rooms_of(request, all[*chosen.meets].row);
    files.finish(chosen);
    progress.finish();
    fmt::print("{}", output::choice::in_words(chosen));
    if (!common.quiet) fmt::print("{}\n", (folder / "choose.csv").string());
    return chosen.meets ? Exit::done : Exit::answer_is_no;
}

}  // namespace

void add_choose(CLI::App& program, const Common& common, Command& chosen) {
    auto* command = program.add_subcommand(
        "choose", "The cheapest form and format that meets a wish on a scene, what it costs, and how far it holds");
    const auto o = std::make_shared<ChooseOptions>();
    command->add_option("SCENE", o->scene, "A scene file, or a name in data/scenes")->required();
    command->add_option("--bits", o->bits, "Correct bits of t that are wanted, at least")
        ->required()
        ->check(CLI::Range(0.0, 53.0));
    command->add_option("--wrong", o->wrong, "Share of the rays that may be decided wrongly (default: 0)")
        ->check(CLI::Range(0.0, 1.0));
    command->add_option("--at", o->at,
                        "Of how many hits the bits are wanted: p50, p99 (default), p99.9, max: every one");
    choice::add_list(*command, "-i,--intersector", o->forms, "Forms, by name or glob (default: all)");
    choice::add_list(*command, "-f,--format", o->formats, "f32, f64 (default: both)");
    auto* const single = command->add_flag("--single", o->single, "One ray at a time is what is paid for");
    command->add_flag("--bulk", o->bulk, "Registers full of rays are what is paid for, where a form has them (default)")
        ->excludes(single);
    command->add_option("--size", o->size, "Picture size, WxH in pixels (default: the scene's)");
    command->add_option("--variant", o->variant, "One variant of a scene that has several");
    choice::add_set(*command, o->set, "Change a number of the scene first: sphere[0].radius=10");
    command->add_flag("--quick", o->quick, "Shorter measurements of time, for a first look");
    command->add_option("-o,--out", o->out, "Folder for the results")->required();
    command->callback([o, &common, &chosen] { chosen = [o, &common] { return run(*o, common); }; });
}

}  // namespace lostbits::analysis
