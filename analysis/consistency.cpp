#include "measure/consistency/consistency.hpp"

#include <fmt/format.h>

#include <memory>

#include "analysis/selection/options.hpp"
#include "analysis/selection/select.hpp"
#include "commands.hpp"
#include "measure/offset/offsets.hpp"
#include "output/consistency/consistency_files.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::analysis {

using measure::consistency::Accord;
using measure::consistency::Check;
using measure::consistency::CheckSummary;
using measure::consistency::ConsistencyRequest;
using measure::consistency::RowChecks;
using scene::file::Scene;

namespace {

struct ConsistencyOptions : selection::SharedOptions {
    std::vector<std::string> checks{"*"};
};

/// `12 of 3072 (0.39%)`
std::string share_text(std::uint64_t part, std::uint64_t whole) {
    return fmt::format("{} of {} ({:.3g}%)", part, whole, 100 * measure::truth::fraction(part, whole));
}

/// The result of one check of a row in words; empty if there is nothing to say.
std::string check_text(const Check& check, const CheckSummary& s) {
    std::string text;
    const auto add = [&text](const std::string& words) { text += (text.empty() ? "" : "; ") + words; };
    if (check.name == "end") {
        const auto yes = s.of(Accord::second_alone);
        if (s.asked() > 0 && yes > 0 && yes < s.asked())
            add("a hit exactly at the end of the ray counts for " + share_text(yes, s.asked()));
        return text;
    }
    if (s.decisions() > 0) add("decisions differ for " + share_text(s.decisions(), s.asked()));
    const double apart = s.excess.quantile(1);  // NaN if no numbers are compared
    if (s.of(Accord::other_number) > 0 && !(apart > 0))
        add("numbers differ for " + share_text(s.of(Accord::other_number), s.asked()));
    if (s.of(Accord::by_inputs) > 0 && !check.numbers)
        add("decisions differ because of rounded inputs, not the form, for " +
            share_text(s.of(Accord::by_inputs), s.asked()));
    if (apart > 0)
        add(fmt::format("{} are up to {:.3g} ulps further apart than the exact ones",
                        check.name == "placed" ? "both t" : "both ends", apart));
    return text;
}

void say_row(const ConsistencyRequest& request, const measure::evaluate::TestedForm& row, const RowChecks& checks) {
    const std::string name = fmt::format("{} {}", row.form->info->name, row.format.name);
    std::string alike;
    for (std::size_t c = 0; c < checks.size(); ++c) {
        if (checks[c].asked() == 0) continue;
        const std::string text = check_text(*request.checks[c], checks[c]);
        if (text.empty()) alike += fmt::format("{}{}", alike.empty() ? "" : ", ", request.checks[c]->name);
        else fmt::print("  {} {}: {}\n", name, request.checks[c]->name, text);
    }
    if (!alike.empty()) fmt::print("  {} gives the same answers: {}\n", name, alike);
}

/// Compares on one scene. Returns the number of questions whose exact answer is not proved.
std::uint64_t compare_on_scene(ConsistencyRequest request, const ConsistencyOptions& o, const Common& common,
                               output::file::Progress& progress, const SceneFolders::Complete& complete) {
    const auto folder = std::filesystem::path(o.out) / request.scene.id;
    output::consistency::ConsistencyFiles files(
        request, {.folder = folder, .pixels_csv = o.pixels == "csv", .singles = o.pictures == "all"});
    // Opening the files of many forms and checks takes seconds, so the estimate starts after it.
    output::file::Estimate estimate(progress, request.scene.id, request.scene.pixels() * request.rows.size(),
                                    common.quiet);
    request.progress = advancing(progress, &estimate);
    const auto rows = measure::consistency::run_consistency(
        request, [&files](std::size_t row, const auto& band) { files.band(row, band); });
    files.finish(rows);
    complete();
    std::uint64_t unresolved = 0;
    for (const RowChecks& row : rows) {
        for (const CheckSummary& s : row) unresolved += s.of(Accord::unresolved);
    }
    if (!common.quiet) {
        progress.aside([&] {
            fmt::print("{}\n", (folder / "contact.png").string());
            for (std::size_t r = 0; r < rows.size(); ++r) say_row(request, request.rows[r], rows[r]);
        });
    }
    return unresolved;
}

Exit run(const ConsistencyOptions& o, const Common& common) {
    require_folder(o.out);
    auto rows = selection::cross(selection::select_forms(o.forms), selection::select_formats(o.formats));
    std::erase_if(rows, [](const auto& row) { return !measure::consistency::can_be_compared(*row.form); });
    if (rows.empty())
        throw NothingSelected("consistency needs forms for spheres or boxes, and none is selected; try -i 'sphere.*'");
    const auto checks = selection::select_rows(measure::consistency::checks(), o.checks, "check", "--check");
    auto scenes = scenes_of_solids(o, rows, "consistency", common);
    const selection::ThreadLimit limit(common.threads);

    std::vector<ConsistencyRequest> requests;
    std::uint64_t units = 0;
    for (const Scene& scene : scenes) {
        measure::offset::require_few_solids(scene);
        auto fitting = selection::fitting(rows, [&](Shapes forms) { return scene.meets(forms); });
        auto asked = measure::consistency::checks_for(scene, fitting, checks);
        if (asked.empty())
            throw InputError(fmt::format(
                "--check: none of these checks applies to the selected forms on scene {}; light needs a [light], and "
                "segment, short and light need a form that takes directions of any length; try --check reverse",
                scene.id));
        requests.push_back(
            {.scene = scene, .rows = std::move(fitting), .checks = std::move(asked), .limit = {.stop = common.stop}});
        units += scene.pixels() * requests.back().rows.size();
    }
    SceneFolders folders(scenes, o.out, common);
    for (const auto& scene : scenes) selection::note_numbers(scene, o.scenes.set, rows, common.quiet);

    output::file::Progress progress(units, "consistency", common.progress, common.quiet);
    return end_with_unproved(folders.each(requests.size(), progress, [&](std::size_t k, const auto& complete) {
        return compare_on_scene(requests[k], o, common, progress, complete);
    }));
}

}  // namespace

void add_consistency(const shell::Command& program, const Common& common) {
    auto command = program.add_command("consistency",
                                       "Whether a form gives one answer to a question put in two ways: closest and any "
                                       "hit, one ray and packs, a segment from either end");
    const auto o = std::make_shared<ConsistencyOptions>();
    o->forms = {"*"};
    o->formats = {"f32"};
    o->scenes.stop = common.stop;
    o->scenes.all_ahead = true;
    selection::add_scenes(command, *o, "; spheres or boxes");
    selection::add_forms(command, o->forms, "all that fit");
    selection::add_formats(command, o->formats, "f32");
    command.add_list("--check", o->checks, "Checks, by name or glob (default: all); `lostbits list checks`");
    selection::add_changes(command, o->scenes, "sphere[0].radius=10");
    selection::add_pixels(command, *o);
    selection::add_pictures(command, o->pictures);
    selection::add_out(command, o->out);
    command.runs([o, &common] { return run(*o, common); });
}

}  // namespace lostbits::analysis
