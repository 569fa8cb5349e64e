#include <fmt/format.h>

#include <algorithm>

#include "analysis/choice/select.hpp"
#include "measure/edges/nearest.hpp"
#include "output/edges/nearest_files.hpp"
#include "output/sweep/worst_files.hpp"
#include "scene/rays/made_rows.hpp"
#include "sweep_parts.hpp"

namespace lostbits::analysis {

using measure::map::MapRow;

void run_search(const std::filesystem::path& path, const Chosen& chosen, const SweepOptions& o, const Common& common) {
    scene::sweep::SearchFile search(path, choice::read_changes(o.changes).set);
    search.title += o.changes.in_title();
    measure::sweep::WorstRequest request{
        .search = &search,
        .rows = choice::fitting(chosen.rows, [&](Shapes forms) { return forms == search.shape; }),
        .metrics = {},
        .limit = {.stop = common.stop}};
    Solid<double> any;  // labels do not depend on its numbers
    any.shape = search.shape;
    request.metrics =
        chosen.made.for_forms(choice::measured({chosen.made.find(search.metric)}, request.rows),
                              measure::map::forms_of(request.rows), measure::blame::Setting{std::span(&any, 1)});
    const auto folder = std::filesystem::path(o.out) / search.id;
    const auto owner = chosen.own(folder, path, common);
    if (owner) probe(folder / "worst.csv");
    request.share = chosen.division().share();
    Watched progress(search.id, request.share.of_units(request.rows.size()).size(), common);
    request.progress = progress.advancing();
    const auto found =
        chosen.division().result_of("sweep " + search.id, [&request] { return measure::sweep::find_worst(request); });
    progress.finish();
    if (!found) return;
    if (std::ranges::none_of(*found, [](const auto& w) { return w.has_value(); })) {
        throw NothingSelected(path.string() +
                              ": no form hit anything with a ray of these ranges; distance_radii and impact_radii may "
                              "exclude all of the other ranges");
    }
    output::sweep::write_worst(folder, request, *found);
    if (!common.quiet) fmt::print("{}\n", (folder / "worst.csv").string());
}

void run_edge_search(const std::filesystem::path& path, const Chosen& chosen, const SweepOptions& o,
                     const Common& common) {
    const auto data = choice::data_folder(common.data);
    scene::sweep::EdgeSearchFile search(path, data, choice::read_changes(o.changes).set);
    search.title += o.changes.in_title();
    measure::edges::EdgeRequest request{
        .search = &search,
        .rows = choice::fitting(chosen.rows, [&](Shapes forms) { return search.meets(forms); }),
        .limit = {.stop = common.stop}};
    for (const MapRow& row : request.rows)
        if (scene::rays::maker_of(*row.form) != nullptr)
            throw InputError(std::string(row.form->info->name) + ": the rays of " + search.id +
                             " are not those of a camera; name the form without @ray-");
    const auto folder = std::filesystem::path(o.out) / search.id;
    const auto owner = chosen.own(folder, path, common);
    if (owner) probe(folder / "worst.csv");
    request.share = chosen.division().share();
    Watched progress(search.id, measure::edges::sought.size() * request.share.of_units(request.rows.size()).size(),
                     common);
    request.progress = progress.advancing();
    const auto found =
        chosen.division().result_of("sweep " + search.id, [&request] { return measure::edges::find_nearest(request); });
    progress.finish();
    if (!found) return;
    const output::edges::NearestFiles files{request, *found, choice::name_of_scene(search.scene, data)};
    files.write(folder);
    if (common.quiet) return;
    fmt::print("{}\n", (folder / "worst.csv").string());
    for (std::size_t r = 0; r < found->size(); ++r) fmt::print("{}\n", files.sentence(r));
}

}  // namespace lostbits::analysis
