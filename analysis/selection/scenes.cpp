#include "analysis/selection/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "analysis/selection/ray_numbers.hpp"
#include "analysis/selection/select.hpp"
#include "intersect/process/process_state.hpp"
#include "number/error.hpp"
#include "output/attribution/explain_command.hpp"
#include "scene/rays/stored_mesh.hpp"
#include "scene/toml/file_names.hpp"
#include "text/count_with_noun.hpp"
#include "text/shell_word.hpp"

namespace lostbits::analysis::selection {

using scene::file::Scene;

std::vector<Scene> load_scenes(const SceneOptions& options, const std::filesystem::path& data) {
    scene::file::LoadOptions load_options{.stop = options.stop};
    if (!options.size.empty()) load_options.size = parse_size(options.size);
    for (const auto& assignment : options.set)
        load_options.overrides.push_back(scene::toml::parse_override(assignment));
    std::vector<Scene> scenes;
    std::set<std::string> ids;
    for (const std::string& given_name : options.names) {
        const scene::file::SceneName name = scene::file::find_scene(given_name, data);
        if (name.variant && !options.variant.empty() && *name.variant != options.variant)
            throw InputError(fmt::format("--variant {}: {} names another variant; leave out --variant", options.variant,
                                         given_name));
        load_options.variant = options.variant.empty() ? name.variant : std::optional(options.variant);

        for (auto& scene : scene::file::load_scene(name.path, load_options)) {
            if (options.refuses_ranges && !scene.range.is_whole())
                throw InputError(
                    fmt::format("{}: the rays of {} have a range, but this command tests rays without end from t = 0; "
                                "leave out the [rays] table",
                                given_name, scene.id));
            // A title describes the numbers in the file: "… 100 away" would be wrong after --set.
            if (!options.set.empty()) scene.title += fmt::format(", with {}", fmt::join(options.set, ", "));
            if (!ids.insert(scene.id).second)
                throw InputError(
                    fmt::format("{}: scene \"{}\" is given twice, and both would write to the same folder; "
                                "leave out one of the two",
                                given_name, scene.id));
            for (const std::string& remark : scene.remarks())
                fmt::print(stderr, "lostbits: {}: {}\n", given_name, remark);
            scenes.push_back(std::move(scene));
        }
    }
    return scenes;
}

std::string scene_arguments(const Scene& scene, const std::filesystem::path& data) {
    using text::shell_word;
    if (scene.path.parent_path() == data / "scenes") return shell_word(scene.id);
    const std::string stem = scene.path.stem().string();
    const std::string variant = scene.id == stem ? "" : " --variant " + shell_word(scene.id.substr(stem.size() + 1));
    return shell_word(scene.path.string()) + variant;
}

std::string sweep_argument(const std::filesystem::path& path, const std::filesystem::path& data) {
    return text::shell_word(sweep_name_in_claims(path, data));
}

std::string scene_name_in_claims(const Scene& scene, const std::filesystem::path& data) {
    if (scene.path.parent_path() == data / "scenes") return scene.id;
    const std::string stem = scene.path.stem().string();
    return scene.path.string() + (scene.id == stem ? "" : scene.id.substr(stem.size()));
}

std::string sweep_name_in_claims(const std::filesystem::path& path, const std::filesystem::path& data) {
    const auto inside = path.lexically_relative(data / "sweeps");
    const bool is_in_data = !inside.empty() && *inside.begin() != "..";
    return (is_in_data ? std::filesystem::path(inside).replace_extension() : path).string();
}

std::filesystem::path data_folder(const std::string& data_option) {
    namespace fs = std::filesystem;
    if (!data_option.empty()) return data_option;
    if (const char* variable = intersect::process::own_environment("LOSTBITS_DATA")) return variable;
    if (fs::is_directory("data/scenes")) return "data";
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
    // The data folders beside an unpacked program, in a build tree, and in an installation.
    for (const char* const relative : {"data", "../data", "../share/lostbits/data"}) {
        const fs::path folder = (program / relative).lexically_normal();
        if (!program.empty() && fs::is_directory(folder / "scenes", error)) return folder;
    }
    return "data";
}

std::filesystem::path form_flags_folder() {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
    const fs::path installed = (program / "../lib/lostbits").lexically_normal();
    return fs::exists(installed / "form.flags", error) ? installed : program;
}

scene::file::Scene load_one_scene(const SceneOptions& options, const std::filesystem::path& data) {
    auto scenes = load_scenes(options, data);
    if (scenes.size() == 1) return std::move(scenes.front());
    std::string names;
    for (const auto& scene : scenes) names += (names.empty() ? "" : ", ") + scene.id;
    throw InputError(fmt::format("{}: has {} variants, and this command takes one; name one of {}",
                                 options.names.front(), scenes.size(), names));
}

std::vector<measure::evaluate::TestedForm> select_timed_forms(const scene::file::Scene& scene,
                                                              const SelectedForms& chosen) {
    return select_timed_forms(scene.id, chosen, [&scene](Shapes forms) { return scene.accepts(forms); });
}

std::vector<measure::evaluate::TestedForm> select_timed_forms(const std::string& id, const SelectedForms& chosen,
                                                              const ShapePredicate& can_test) {
    // A march tests all primitives at once, and its time depends on its steps, so a time per ray and primitive says
    // nothing.
    const ShapePredicate can_be_timed = [&can_test](Shapes forms) { return are_primitives(forms) && can_test(forms); };
    auto timed = tested_forms_handling(chosen, id, can_be_timed);
    if (!timed.empty()) return timed;
    throw NothingSelected("none of the selected forms is for the primitives of " + id +
                          forms_advice(chosen.tested_forms, can_be_timed));
}

bool are_ray_files(const RayFileOptions& options, const std::vector<std::string>& subjects) {
    if (options.container != "auto" || !options.columns.empty()) return true;
    const auto is_file = [](const std::string& name) {
        std::string ending = std::filesystem::path(name).extension().string();
        std::ranges::transform(ending, ending.begin(),
                               [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return ending == ".csv" || ending == ".npy";
    };
    return std::ranges::all_of(subjects, is_file);
}

void require_no_misplaced_options(const RayFileOptions& options, const std::vector<std::string>& subjects,
                                  const std::vector<std::pair<const char*, bool>>& scene_options, const char* command) {
    std::vector<std::pair<std::string, bool>> file_options{{"--answer-format", !options.answer_format.empty()},
                                                           {"--skip", options.skip != 0}};
    for (const RayFileOption& option : ray_file_options())
        file_options.emplace_back(option.name, option.is_given(options));
    for (const ShapeRow& shape_row : shape_rows)
        file_options.emplace_back(fmt::format("--{}", shape_row.name),
                                  !options.primitives.values_of(shape_row.shape).empty());

    const auto refuse = [](const auto& misplaced_options, const std::string& why, const std::string& remedy) {
        for (const auto& [name, is_given] : misplaced_options) {
            if (is_given) throw InputError(fmt::format("{0}: {1}; leave out {0}{2}", name, why, remedy));
        }
    };
    if (are_ray_files(options, subjects))
        return refuse(scene_options, "is for a scene, but these are files of rays", "");
    refuse(file_options, fmt::format("is for files of rays, but {} is taken for a scene", subjects.front()),
           ", or add --container csv, npy or raw");
    if (subjects.size() > 1)
        throw InputError(
            fmt::format("{}: {} takes one scene, or files of rays, which end in .csv or .npy or have --container; name "
                        "one scene",
                        subjects[1], command));
}

namespace {

std::string answers_column(const scene::ray_file::Layout& layout) {
    return layout.columns()[layout.index_of(scene::ray_file::slot_of(layout.answer_kind()))].name;
}

}  // namespace

OpenedRays open_rays(const RayFileOptions& options, const std::vector<std::string>& files,
                     const std::filesystem::path& data) {
    const auto target_scene = load_scene_of_rays(options, data);
    constexpr std::size_t max_primitives = 1024;
    if (target_scene && target_scene->primitive_count() > max_primitives)
        throw InputError(fmt::format(
            "--scene {}: has {} primitives; a sample of the rays is tested with each of them many times, and at most "
            "{} are allowed; use judge, which takes meshes of any size, or give each ray the primitive that it meets "
            "in columns of the file",
            options.scene, target_scene->primitive_count(), max_primitives));

    // Opens the files, and joins them into one.
    OpenedRays result{.id = {}, .quoted_files = {}, .ray_file = {}, .options = {}, .shapes = Shapes()};
    std::vector<std::unique_ptr<scene::ray_file::RayFile>> ray_files;
    for (const std::string& file : files) {
        ray_files.push_back(open_file(options, file, shared_shape(options, target_scene)));
        if (ray_files.back()->layout().answer_kind() > scene::ray_file::AnswerKind::first_hit)
            throw InputError(
                fmt::format("{}: has answers about the whole surface of a mesh (column {}), which only judge "
                            "takes; name a file of rays",
                            file, answers_column(ray_files.back()->layout())));
        result.id += (result.id.empty() ? "" : "+") + scene::toml::result_name(file);
        result.quoted_files += (result.quoted_files.empty() ? "" : " ") + text::shell_word(file);
    }
    result.ray_file = scene::ray_file::join_ray_files(std::move(ray_files));

    // Changes by the command line.
    result.options = {.result_name = result.id,
                      .primitives = shared_primitives(options, target_scene, result.ray_file->format()),
                      .contract = answer_contract(options, *result.ray_file)};
    if (target_scene)
        result.options.mesh = scene::rays::make_stored_mesh(*target_scene, result.ray_file->format().parameters);
    const std::vector<Primitive<double>> representatives = result.options.representatives();
    transform_by_records(*result.ray_file, representatives);
    result.shapes = shapes_of_rays(result.ray_file->layout(), representatives);
    return result;
}

void warn_of_rounded_values(const std::string& files, std::uint64_t count, const Format& format) {
    if (count == 0) return;
    fmt::print(
        stderr,
        "lostbits: {}: {} representable in {} and {} rounded; name the format in which the answers were computed "
        "with --answer-format\n",
        files, text::count_with_noun(count, "value is not", "values are not"), format.name,
        count == 1 ? "was" : "were");
}

}  // namespace lostbits::analysis::selection
