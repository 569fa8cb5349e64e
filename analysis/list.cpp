#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>

#include "analysis/selection/external.hpp"
#include "analysis/selection/select.hpp"
#include "commands.hpp"
#include "intersect/conventions.hpp"
#include "measure/attribution/culprits.hpp"
#include "measure/consistency/check.hpp"
#include "measure/offset/strategy.hpp"
#include "output/file/escape.hpp"
#include "scene/check/claims_file.hpp"
#include "scene/file/scene.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/exhaustive_file.hpp"
#include "scene/sweep/search_file.hpp"
#include "scene/sweep/sweep_file.hpp"
#include "scene/toml/file_names.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::analysis {

using scene::check::Claim;
using scene::sweep::SweepKind;

namespace {

using Row = std::vector<std::string>;

/// A list as a table of texts. The first column has the names; the others explain them.
struct Listing {
    std::vector<std::string> columns;
    std::vector<Row> rows = {};
};

/// Makes a row of texts for each item of a table.
template <class Items, class MakeRow>
Listing make_listing(std::vector<std::string> columns, const Items& items, const MakeRow& make_row) {
    Listing list{std::move(columns)};
    for (const auto& item : items) {
        Row& row = list.rows.emplace_back();
        for (const auto& text : make_row(item)) row.emplace_back(text);
    }
    return list;
}

/// A row of `n` texts, which the row does not own.
template <std::size_t n>
using Cells = std::array<std::string_view, n>;

/// Returns the right answer for a ray that starts inside a primitive, in one word.
std::string inside_answer(intersect::Inside inside, Shape shape) {
    if (inside != intersect::Inside::usual)
        return std::string(intersect::inside_names[static_cast<std::size_t>(inside)]);
    if (!is_primitive(shape)) return "by primitive";
    if (is_flat(shape)) return "none";
    return inside_returns_zero(shape) ? "zero" : "exit";
}

/// The properties of a form, in words.
Row make_form_row(const intersect::table::Intersector& form) {
    const intersect::Info& info = *form.info;
    const char* const roots = info.roots == intersect::Roots::both         ? "both"
                              : info.roots == intersect::Roots::near_only  ? "near"
                              : info.roots == intersect::Roots::first_only ? "first"
                                                                           : "none";
    const char* const at_origin = info.at_origin == intersect::AtOrigin::hit    ? "hit"
                                  : info.at_origin == intersect::AtOrigin::miss ? "miss"
                                                                                : "exit";
    const std::string facing =
        is_flat(form.shape) ? std::string(intersect::facing_names[static_cast<std::size_t>(info.facing)]) : "none";

    return {std::string(info.name),
            std::string(info.title),
            info.direction == intersect::Direction::unit ? "unit" : "any",
            roots,
            info.touching == intersect::Touching::hit ? "hit" : "miss",
            at_origin,
            inside_answer(info.inside, form.shape),
            facing,
            intersect::yields_next_crossing(info, form.shape) ? "yes" : "no",
            selection::formats_text(form),
            std::string(info.source)};
}

Listing intersectors(const CommonOptions& /*common*/) {
    return make_listing({"name", "title", "direction", "roots", "touching", "at_origin", "inside", "facing",
                         "next_crossing", "formats", "source"},
                        lostbits::intersect::table::intersectors(), make_form_row);
}

Listing formats(const CommonOptions& /*common*/) {
    return make_listing({"name", "meaning"}, format_descriptions, [](const FormatDescription& f) {
        return Cells<2>{f.name, f.meaning};
    });
}

/// Methods to transform a ray to the object space of a primitive.
Listing transforms(const CommonOptions& /*common*/) {
    return make_listing(
        {"name", "title", "direction", "source"}, intersect::transform::transform_methods(), [](const auto& method) {
            return Cells<4>{method.info->name, method.info->title,
                            method.info->direction == intersect::Direction::unit ? "unit" : "any", method.info->source};
        });
}

/// Methods to compute the bounding box of a primitive.
Listing box_methods(const CommonOptions& /*common*/) {
    return make_listing({"name", "title", "source"}, intersect::bounding_box::box_methods(), [](const auto& method) {
        return Cells<3>{method.info->name, method.info->title, method.info->source};
    });
}

/// Ray generators, which make the ray of a pixel.
Listing ray_generators(const CommonOptions& /*common*/) {
    return make_listing({"name", "title", "begins", "source"}, scene::camera::ray_generators(), [](const auto& m) {
        return Cells<4>{m.info->name, m.info->title, m.info->starts_on_near_plane ? "near plane" : "eye",
                        m.info->source};
    });
}

Listing metric_table(const CommonOptions& /*common*/) {
    Listing list = make_listing(
        {"name", "unit", "layer", "default", "meaning"}, measure::metric::metrics(),
        [](const measure::metric::Metric& metric) {
            return Cells<5>{metric.name, metric.unit, metric.layer, metric.is_default ? "yes" : "no", metric.meaning};
        });
    measure::metric::MetricSet metric_set;
    const auto add = [&](const char* name, const char* example, bool has_unit, const std::string& more_meaning) {
        const measure::metric::Metric& m = *metric_set.find(example);
        list.rows.push_back({name, has_unit ? std::string(m.unit) : "", std::string(m.layer), "no",
                             std::string(m.meaning) + more_meaning});
    };
    for (const char* name : {"contribution:LABEL", "cancellation:LABEL"})
        add(name, name, true, "; `lostbits list labels` shows the labels of each form");
    add("step:NAME", "step:origin", true,
        fmt::format("; one of {}", fmt::join(intersect::transform::step_names, ", ")));
    add("tolerance:LENGTH", "tolerance:0.001", false, ", or any other number");
    add("enough_bits:BITS", "enough_bits:16", false, ", or any other number");
    return list;
}

/// Rules for the origin of the next ray, and how many operations each costs.
Listing strategies(const CommonOptions& /*common*/) {
    std::vector<std::string> columns{"name", "title"};
    for (const ShapeRow& shape : shape_rows) columns.push_back("operations_" + std::string(shape.name));
    columns.emplace_back("source");
    return make_listing(columns, measure::offset::strategies(), [](const measure::offset::Strategy& strategy) {
        Row row{std::string(strategy.name), std::string(strategy.title)};
        for (const ShapeRow& shape : shape_rows) row.push_back(std::to_string(strategy.operation_count(shape.shape)));
        row.emplace_back(strategy.source);
        return row;
    });
}

/// Pairs of questions that should have the same answer.
Listing checks(const CommonOptions& /*common*/) {
    return make_listing({"name", "title", "first", "second"}, measure::consistency::checks(),
                        [](const measure::consistency::Check& c) {
                            return Cells<4>{c.name, c.title, c.first_question, c.second_question};
                        });
}

/// The devices that run shaders.
Listing devices(const CommonOptions& common) {
    Listing list{{"name", "renderer", "version", "dot", "arithmetic"}};
    for (const std::string& kind : selection::select_devices({"all"})) {
        const selection::DeviceReport report = selection::ask_device(kind, common.external);
        const auto fact = [&report](std::string_view key) {
            const auto found =
                std::ranges::find(report.facts, key, [](const auto& f) -> std::string_view { return f.first; });
            return found == report.facts.end() ? "" : found->second;
        };
        if (report.problem.empty())
            list.rows.push_back({kind, fact("renderer"), fact("version"), fact("f32.dot"), fact("digest")});
    }
    if (list.rows.empty() && !common.quiet)
        fmt::print(stderr,
                   "lostbits: no driver can run shaders here; `lostbits devices` says what each of them needs\n");
    return list;
}

/// The labels of each form's operations, recorded with one primitive of its shape.
Listing labels(const CommonOptions& /*common*/) {
    std::vector<Primitive<double>> primitives;
    for (const ShapeRow& shape_row : shape_rows)
        primitives.push_back(primitive_around<double>(shape_row.shape, {0, 0, 5}, 1));
    const intersect::MarchConstants<double> march{};  // labels do not depend on its numbers
    return make_listing({"name", "labels"}, lostbits::intersect::table::intersectors(), [&](const auto& form) {
        auto form_labels = measure::attribution::labels_of(
            form, {!is_primitive(form.shape) ? std::span(primitives).first(1) : std::span(primitives), &march});
        // The order on the tape depends on the order in which the compiler evaluates arguments.
        std::ranges::sort(form_labels);
        return Row{std::string(form.info->name), fmt::format("{}", fmt::join(form_labels, " "))};
    });
}

Listing scenes(const CommonOptions& common) {
    Listing list{{"name", "variants", "inputs", "title"}};
    for (const auto& path : scene::file::list_scene_files(selection::data_folder(common.data))) {
        const scene::file::SceneFile file(path);
        const auto all = file.load();
        list.rows.push_back({path.stem().string(), fmt::format("{}", fmt::join(file.variants(), " ")),
                             all.front().inputs == scene::file::InputRounding::shared ? "shared" : "own",
                             all.front().title});
    }
    return list;
}

/// The subject of a sweep (its axes, the number of its cases, or the metric of its search) and its title.
std::pair<std::string, std::string> axis_and_title(const std::filesystem::path& path,
                                                   const std::filesystem::path& data) {
    const auto describe = [](const auto& file, const auto& axis) { return std::pair(axis(file), file.title); };
    switch (scene::sweep::read_sweep_kind(path)) {
        case SweepKind::cases:
            return describe(scene::sweep::CaseFile(path),
                            [](const auto& f) { return text::count_with_noun(f.size(), "case"); });
        case SweepKind::search:
            return describe(scene::sweep::SearchFile(path), [](const auto& f) { return "search for " + f.metric; });
        case SweepKind::edge_search:
            return describe(scene::sweep::EdgeSearchFile(path, data),
                            [](const auto&) { return std::string("search along edges"); });
        case SweepKind::every_float:
            return describe(scene::sweep::ExhaustiveFile(path, data),
                            [](const auto& f) { return "every float of " + f.axis.name; });
        case SweepKind::axes: break;
    }

    return describe(scene::sweep::SweepFile(path, data), [](const auto& f) {
        std::string text;
        for (const scene::sweep::Axis& axis : f.axes) text += (text.empty() ? "" : " x ") + axis.name;
        return text;
    });
}

Listing sweeps(const CommonOptions& common) {
    Listing list{{"name", "axis", "title"}};
    const auto data = selection::data_folder(common.data), root = scene::toml::find_data_folder(data, "sweeps");
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
        if (entry.path().extension() != ".toml") continue;
        const auto [axis, title] = axis_and_title(entry.path(), data);
        list.rows.push_back({entry.path().lexically_relative(root).replace_extension().string(), axis, title});
    }
    std::ranges::sort(list.rows);
    return list;
}

/// The claims, in the order of the files, with the verdicts that they state. Nothing is measured; `lostbits check` does
/// that.
Listing claims(const CommonOptions& common) {
    Listing list{{"id", "verdict", "profile", "subject", "form", "format", "statement"}};
    const auto root = scene::toml::find_data_folder(selection::data_folder(common.data), "claims");
    for (const auto& path : scene::check::list_claim_files(root)) {
        for (const Claim& claim : scene::check::read_claims(path)) {
            list.rows.push_back({claim.id, std::string(name_of(claim.verdict)),
                                 std::string(scene::check::name_of(claim.profile)), claim.subject_name(),
                                 claim.tested_name(), claim.format, claim.statement});
        }
    }
    return list;
}

void print(const Listing& list) {
    std::vector<std::size_t> widths;
    for (std::size_t c = 0; c < list.columns.size(); ++c) {
        std::size_t w = list.columns[c].size();
        for (const auto& row : list.rows) w = std::max(w, row[c].size());
        widths.push_back(w);
    }

    const auto print_line = [&](const std::vector<std::string>& cells) {
        std::string text;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            text += c + 1 == cells.size() ? cells[c] : fmt::format("{:<{}}  ", cells[c], widths[c]);
        }
        text.erase(text.find_last_not_of(' ') + 1);
        fmt::print("{}\n", output::file::terminal_line(text));
    };
    print_line(list.columns);
    for (const auto& row : list.rows) print_line(row);
}

void print_json(const Listing& list) {
    auto array = nlohmann::ordered_json::array();
    for (const auto& row : list.rows) {
        nlohmann::ordered_json object;
        for (std::size_t c = 0; c < row.size(); ++c) object[list.columns[c]] = row[c];
        array.push_back(std::move(object));
    }
    fmt::print("{}\n", array.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

/// The lists, in the order of the help.
constexpr std::pair<const char*, Listing (*)(const CommonOptions&)> lists[] = {
    {"forms", intersectors},
    {"intersectors", intersectors},
    {"labels", labels},
    {"formats", formats},
    {"metrics", metric_table},
    {"scenes", scenes},
    {"sweeps", sweeps},
    {"claims", claims},
    {"strategies", strategies},
    {"checks", checks},
    {"transforms", transforms},
    {"boxes", box_methods},
    {"generators", ray_generators},
    {"devices", devices},
};

ExitStatus run(const std::string& list_name, bool json, const CommonOptions& common) {
    const Listing chosen =
        std::ranges::find(lists, list_name, [](const auto& list) { return list.first; })->second(common);
    if (json) print_json(chosen);
    else print(chosen);
    return ExitStatus::done;
}

}  // namespace

void add_list(const shell::Command& program, const CommonOptions& common) {
    auto command = program.add_command("list",
                                       "List what you can name: forms, formats, metrics, scenes, sweeps, claims and "
                                       "seven other kinds of things");
    const auto list_name = std::make_shared<std::string>("forms");
    const auto json = std::make_shared<bool>(false);
    std::vector<std::string> names;
    for (const auto& [name, list] : lists) names.emplace_back(name);
    command.add("WHAT", *list_name, "What to list (default: forms, for which intersectors is another name)",
                shell::one_of(names));
    command.add("--json", *json, "Print a JSON array");
    command.set_action([list_name, json, &common] { return run(*list_name, *json, common); });
}

}  // namespace lostbits::analysis
