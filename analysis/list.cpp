#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "analysis/selection/doors.hpp"
#include "analysis/selection/select.hpp"
#include "commands.hpp"
#include "measure/blame/culprits.hpp"
#include "measure/consistency/check.hpp"
#include "measure/offset/strategy.hpp"
#include "output/file/escape.hpp"
#include "scene/claim/claims_file.hpp"
#include "scene/file/scene.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/exhaustive_file.hpp"
#include "scene/sweep/search_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::analysis {

using scene::claim::Claim;
using scene::sweep::SweepKind;

namespace {

/// A list as a table of words: the first column names, the others explain.
struct Listing {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
};

/// The right answer to a ray that starts inside.
std::string from_inside(intersect::Inside said, Shape shape) {
    if (said != intersect::Inside::usual) return std::string(intersect::inside_names[static_cast<std::size_t>(said)]);
    if (!is_solid(shape)) return "by solid";
    if (is_flat(shape)) return "none";
    return zero_inside(shape) ? "zero" : "exit";
}

Listing intersectors() {
    Listing l{{"name", "title", "direction", "roots", "touching", "at_origin", "inside", "facing", "formats", "source"},
              {}};
    for (const intersect::table::Intersector& i : lostbits::intersect::table::intersectors()) {
        const intersect::Info& info = *i.info;
        const char* roots = info.roots == intersect::Roots::both         ? "both"
                            : info.roots == intersect::Roots::near_only  ? "near only"
                            : info.roots == intersect::Roots::first_only ? "first only"
                                                                         : "none";
        l.rows.push_back(
            {std::string(info.name), std::string(info.title),
             info.direction == intersect::Direction::unit ? "unit" : "any", roots,
             info.touching == intersect::Touching::hit ? "hits" : "misses",
             info.at_origin == intersect::AtOrigin::hit    ? "hits"
             : info.at_origin == intersect::AtOrigin::miss ? "misses"
                                                           : "exit",
             from_inside(info.inside, i.shape),
             is_flat(i.shape) ? std::string(intersect::facing_names[static_cast<std::size_t>(info.facing)]) : "none",
             selection::formats_of(i), std::string(info.source)});
    }
    return l;
}

Listing formats() {
    Listing l{{"name", "meaning"}, {}};
    for (const FormatHelp& f : format_help) l.rows.push_back({std::string(f.name), std::string(f.meaning)});
    return l;
}

/// Ways into the space of a solid under a matrix.
Listing spaces() {
    Listing l{{"name", "title", "direction", "source"}, {}};
    for (const intersect::space::Space& s : intersect::space::spaces())
        l.rows.push_back({std::string(s.info->name), std::string(s.info->title),
                          s.info->direction == intersect::Direction::unit ? "unit" : "any",
                          std::string(s.info->source)});
    return l;
}

/// Ways of computing the box around a solid.
Listing hulls() {
    Listing l{{"name", "title", "source"}, {}};
    for (const intersect::hull::HullWay& way : intersect::hull::hulls())
        l.rows.push_back({std::string(way.info->name), std::string(way.info->title), std::string(way.info->source)});
    return l;
}

/// Ways to make the ray of a pixel.
Listing makers() {
    Listing l{{"name", "title", "begins", "source"}, {}};
    for (const scene::camera::Maker& m : scene::camera::makers())
        l.rows.push_back({std::string(m.info->name), std::string(m.info->title),
                          m.info->from_near ? "near plane" : "eye", std::string(m.info->source)});
    return l;
}

Listing metric_table() {
    Listing l{{"name", "unit", "layer", "default", "meaning"}, {}};
    for (const measure::metric::Metric& m : measure::metric::metrics()) {
        l.rows.push_back({std::string(m.name), std::string(m.unit), std::string(m.layer), m.by_default ? "yes" : "no",
                          std::string(m.meaning)});
    }
    measure::metric::MetricSet made;
    for (const char* name : {"contribution:LABEL", "cancellation:LABEL"}) {
        const measure::metric::Metric& m = *made.find(name);
        l.rows.push_back({name, std::string(m.unit), std::string(m.layer), "no",
                          std::string(m.meaning) + "; `lostbits list labels` shows the labels of each form"});
    }
    const measure::metric::Metric& step = *made.find("step:origin");
    l.rows.push_back(
        {"step:NAME", std::string(step.unit), std::string(step.layer), "no",
         std::string(step.meaning) + fmt::format("; one of {}", fmt::join(intersect::space::step_names, ", "))});
    for (const auto& [name, such_as] :
         {std::pair("tolerance:LENGTH", "tolerance:0.001"), std::pair("enough_bits:BITS", "enough_bits:16")}) {
        const measure::metric::Metric& m = *made.find(such_as);
        l.rows.push_back({name, "", std::string(m.layer), "no", std::string(m.meaning) + ", or any other number"});
    }
    return l;
}

/// Rules for the origin of the next ray, and how many operations each costs.
Listing strategies() {
    Listing l{{"name"}, {}};
    for (const ShapeRow& shape : shape_rows) l.columns.push_back("operations_" + std::string(shape.name));
    l.columns.insert(l.columns.end(), {"source", "title"});
    for (const measure::offset::Strategy& s : measure::offset::strategies()) {
        auto& row = l.rows.emplace_back(1, std::string(s.name));
        for (const ShapeRow& shape : shape_rows) row.push_back(std::to_string(s.operations(shape.shape)));
        row.insert(row.end(), {std::string(s.source), std::string(s.title)});
    }
    return l;
}

/// Pairs of questions that should have one answer.
Listing checks() {
    Listing l{{"name", "title", "first", "second"}, {}};
    for (const measure::consistency::Check& c : measure::consistency::checks())
        l.rows.push_back({std::string(c.name), std::string(c.title), std::string(c.first), std::string(c.second)});
    return l;
}

/// What runs shaders, in a line each.
Listing devices(const Common& common) {
    Listing l{{"name", "renderer", "version", "dot", "arithmetic"}, {}};
    for (const std::string& kind : selection::devices_of({"all"})) {
        const selection::DeviceTold told = selection::ask_device(kind, common.doors);
        const auto fact = [&told](std::string_view key) {
            const auto found =
                std::ranges::find(told.facts, key, [](const auto& f) -> std::string_view { return f.first; });
            return found == told.facts.end() ? "" : found->second;
        };
        if (told.lacks.empty())
            l.rows.push_back({kind, fact("renderer"), fact("version"), fact("f32.dot"), fact("digest")});
    }
    if (l.rows.empty() && !common.quiet)
        fmt::print(stderr,
                   "lostbits: no driver can run shaders here; `lostbits devices` says what each of them lacks\n");
    return l;
}

/// What each form names its operations: those of one solid of its shape.
Listing labels() {
    Listing l{{"name", "labels"}, {}};
    std::vector<Solid<double>> solids;
    for (const ShapeRow& row : shape_rows) solids.push_back(solid_around<double>(row.shape, {0, 0, 5}, 1));
    const intersect::MarchConstants<double> march{};  // labels do not depend on its numbers
    for (const intersect::table::Intersector& form : lostbits::intersect::table::intersectors()) {
        auto all = measure::blame::labels_of(
            form, {!is_solid(form.shape) ? std::span(solids).first(1) : std::span(solids), &march});
        std::ranges::sort(all);  // the order of the tape is the compiler's where arguments are evaluated
        l.rows.push_back({std::string(form.info->name), fmt::format("{}", fmt::join(all, " "))});
    }
    return l;
}

/// `sweeps` in the data folder. InputError where there is none: an empty list would say that all is well.
std::filesystem::path folder_of(const std::filesystem::path& data, const char* what) {
    const auto folder = data / what;
    if (!std::filesystem::is_directory(folder))
        throw InputError(
            fmt::format("{}: is not a folder of {}; name the folder that contains {}/ with --data, or in "
                        "LOSTBITS_DATA",
                        folder.string(), what, what));
    return folder;
}

Listing scenes(const Common& common) {
    Listing l{{"name", "variants", "inputs", "title"}, {}};
    for (const auto& path : scene::file::scene_files(selection::data_folder(common.data))) {
        const scene::file::SceneFile file(path);
        const auto all = file.load();
        l.rows.push_back({path.stem().string(), fmt::format("{}", fmt::join(file.variants(), " ")),
                          all.front().inputs == scene::file::Inputs::shared ? "shared" : "own", all.front().title});
    }
    return l;
}

/// What a sweep runs over: its axes, the number of its cases, or the metric that a search makes large.
std::string axis_of(const std::filesystem::path& path, const std::filesystem::path& data, std::string& title) {
    switch (scene::sweep::sweep_kind(path)) {
        case SweepKind::cases: {
            const scene::sweep::CaseFile file(path);
            title = file.title;
            return fmt::format("{} cases", file.size());
        }
        case SweepKind::search: {
            const scene::sweep::SearchFile file(path);
            title = file.title;
            return "search for " + file.metric;
        }
        case SweepKind::edge_search: {
            const scene::sweep::EdgeSearchFile file(path, data);
            title = file.title;
            return "search along edges";
        }
        case SweepKind::every_float: {
            const scene::sweep::ExhaustiveFile file(path, data);
            title = file.title;
            return "every float of " + file.axis.name;
        }
        case SweepKind::axes: break;
    }
    const scene::sweep::SweepFile file(path, data);
    title = file.title;
    std::string text;
    for (const scene::sweep::Axis& axis : file.axes) text += (text.empty() ? "" : " x ") + axis.name;
    return text;
}

Listing sweeps(const Common& common) {
    Listing l{{"name", "axis", "title"}, {}};
    const auto data = selection::data_folder(common.data), root = folder_of(data, "sweeps");
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
        if (entry.path().extension() != ".toml") continue;
        std::string title, axis = axis_of(entry.path(), data, title);
        l.rows.push_back(
            {entry.path().lexically_relative(root).replace_extension().string(), std::move(axis), std::move(title)});
    }
    std::ranges::sort(l.rows);
    return l;
}

/// In the order of the files; verdicts as they state them, measured by `lostbits check` alone.
Listing claims(const Common& common) {
    Listing l{{"id", "verdict", "profile", "subject", "form", "format", "statement"}, {}};
    const auto root = folder_of(selection::data_folder(common.data), "claims");
    for (const auto& path : scene::claim::claim_files(root)) {
        for (const Claim& c : scene::claim::read_claims(path)) {
            l.rows.push_back({c.id, std::string(name_of(c.verdict)), std::string(scene::claim::name_of(c.profile)),
                              c.subject_name(), c.tested(), c.format, c.statement});
        }
    }
    return l;
}

void print(const Listing& l, bool last_is_long) {
    std::vector<std::size_t> widths;
    for (std::size_t c = 0; c < l.columns.size(); ++c) {
        std::size_t w = l.columns[c].size();
        for (const auto& row : l.rows) w = std::max(w, row[c].size());
        widths.push_back(w);
    }
    const auto line = [&](const std::vector<std::string>& cells) {
        std::string text;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            text += c + 1 == cells.size() && last_is_long ? cells[c] : fmt::format("{:<{}}  ", cells[c], widths[c]);
        }
        text.erase(text.find_last_not_of(' ') + 1);
        fmt::print("{}\n", output::file::terminal_line(text));
    };
    line(l.columns);
    for (const auto& row : l.rows) line(row);
}

void print_json(const Listing& l) {
    auto array = nlohmann::ordered_json::array();
    for (const auto& row : l.rows) {
        nlohmann::ordered_json object;
        for (std::size_t c = 0; c < row.size(); ++c) object[l.columns[c]] = row[c];
        array.push_back(std::move(object));
    }
    fmt::print("{}\n", array.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

Exit run(const std::string& what, bool json, const Common& common) {
    const auto make = [&](const std::string& name) {
        if (name == "formats") return formats();
        if (name == "metrics") return metric_table();
        if (name == "spaces") return spaces();
        if (name == "hulls") return hulls();
        if (name == "makers") return makers();
        if (name == "labels") return labels();
        if (name == "strategies") return strategies();
        if (name == "checks") return checks();
        if (name == "devices") return devices(common);
        if (name == "scenes") return scenes(common);
        if (name == "sweeps") return sweeps(common);
        if (name == "claims") return claims(common);
        return intersectors();
    };
    if (json) print_json(make(what));
    else print(make(what), true);
    return Exit::done;
}

}  // namespace

void add_list(const shell::Command& program, const Common& common) {
    auto command = program.add_command("list",
                                       "List forms (intersectors), labels of their operations, formats, metrics, "
                                       "scenes, sweeps, claims, strategies, checks, spaces, hulls, makers of rays, "
                                       "devices");
    const auto what = std::make_shared<std::string>("forms");
    const auto json = std::make_shared<bool>(false);
    command.add("WHAT", *what, "What to list",
                shell::one_of({"forms", "intersectors", "labels", "formats", "metrics", "scenes", "sweeps", "claims",
                               "strategies", "checks", "spaces", "hulls", "makers", "devices"}));
    command.add("--json", *json, "As a JSON array");
    command.runs([what, json, &common] { return run(*what, *json, common); });
}

}  // namespace lostbits::analysis
