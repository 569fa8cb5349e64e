#include "analysis/choice/subjects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "number/error.hpp"
#include "output/blame/explain_command.hpp"
#include "scene/toml/result_name.hpp"

namespace lostbits::analysis::choice {

bool are_files(const RayFileWords& o, const std::vector<std::string>& subjects) {
    if (o.container != "auto" || !o.columns.empty()) return true;
    const auto is_file = [](const std::string& name) {
        std::string ending = std::filesystem::path(name).extension().string();
        std::ranges::transform(ending, ending.begin(),
                               [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return ending == ".csv" || ending == ".npy";
    };
    return std::ranges::all_of(subjects, is_file);
}

void refuse_others(const RayFileWords& o, const std::vector<std::string>& subjects,
                   const std::vector<std::pair<const char*, bool>>& of_scenes, const char* command) {
    const std::pair<const char*, bool> of_files[] = {
        {"--file-format", !o.format.empty()},  {"--skip", o.skip != 0},
        {"--scene", !o.scene.empty()},         {"--miss", !o.miss.empty()},
        {"--direction", o.direction != "any"}, {"--touching", o.touching != "hit"},
        {"--at-origin", o.at_origin != "hit"}, {"--inside", o.inside != "usual"},
        {"--open-ends", o.open_ends != "none"}};
    std::vector<std::pair<std::string, bool>> solids;
    for (const ShapeRow& row : shape_rows)
        solids.emplace_back(fmt::format("--{}", row.name), !o.solids.of(row.shape).empty());
    const auto refuse = [](const auto& options, const std::string& why) {
        for (const auto& [name, given] : options) {
            if (given) throw InputError(fmt::format("{}{}", name, why));
        }
    };
    if (are_files(o, subjects))
        return refuse(of_scenes, ": is about a scene, and these are files of rays; leave it out");
    const std::string of_a_scene = ": is about files of rays, and " + subjects.front() +
                                   " is taken for a scene; leave it out, or say --container csv, npy or raw";
    refuse(of_files, of_a_scene);
    refuse(solids, of_a_scene);
    if (subjects.size() > 1)
        throw InputError(
            fmt::format("{}: {} is for one scene, or for files of rays, which end in .csv or "
                        ".npy or are named by --container; name one",
                        subjects[1], command));
}

OpenedRays open_rays(const RayFileWords& o, const std::vector<std::string>& files, const std::filesystem::path& data) {
    const auto aimed_at = scene_of(o, data);
    OpenedRays opened{.id = {}, .words = {}, .dump = {}, .terms = {}, .shapes = Shapes()};
    std::vector<std::unique_ptr<scene::dump::Dump>> each;
    for (const std::string& file : files) {
        each.push_back(open_file(o, file, shape_given(o, aimed_at)));
        opened.id += (opened.id.empty() ? "" : "+") + scene::toml::result_name(file);
        opened.words += (opened.words.empty() ? "" : " ") + output::blame::shell_word(file);
    }
    opened.dump = scene::dump::join_dumps(std::move(each));
    opened.terms = {
        .id = opened.id, .solids = solids_given(o, aimed_at, opened.dump->format()), .contract = contract_of(o)};
    put_under_matrices(*opened.dump, opened.terms.solids);
    opened.shapes = shapes_of_rays(opened.dump->layout(), opened.terms.solids);
    return opened;
}

void note_rounded(const measure::choice::FileRays& rays, bool quiet) {
    if (rays.rounded == 0 || quiet) return;
    fmt::print(stderr,
               "lostbits: {}: {} numbers are not numbers of {}, and were rounded to it; name the format that they "
               "were computed in with --file-format\n",
               rays.name, rays.rounded, rays.format.name);
}

}  // namespace lostbits::analysis::choice
