#include "measure/judge/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "analysis/selection/external.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/ray_file_options.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "analysis/shard/pieces.hpp"
#include "commands.hpp"
#include "intersect/conventions.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/file/number_text.hpp"
#include "output/judge/judge_files.hpp"
#include "scene/file/march_table.hpp"
#include "scene/ray_file/number_parser.hpp"
#include "scene/rays/stored_mesh.hpp"
#include "scene/toml/file_names.hpp"
#include "text/count_with_noun.hpp"
#include "text/shell_word.hpp"

namespace lostbits::analysis {

using measure::answer::Outcome;
using measure::judge::JudgeRequest;
using measure::judge::JudgeResult;
using measure::metric::Metric;
using scene::ray_file::RayFile;
using selection::JudgeOptions;

namespace {

/// The metrics of the request, made for its forms.
std::vector<const Metric*> make_metrics(const std::vector<const Metric*>& drawn_metrics, const JudgeRequest& request,
                                        bool has_matrices, measure::metric::MetricSet& metric_set) {
    std::vector<measure::evaluate::TestedForm> tested_forms = request.tested_forms;
    std::erase_if(tested_forms, [&request](const measure::evaluate::TestedForm& tested_form) {
        return request.is_file_form(tested_form);
    });
    if (tested_forms.empty()) return selection::with_default_metrics(drawn_metrics, request.tested_forms);

    // The operations of a form depend on the shapes of the primitives, and on whether matrices place them.
    scene::rays::RayGroup group;
    group.primitives = scene::rays::representatives_of(request.primitives, request.mesh.get());
    if (group.primitives.empty()) {
        group.primitives.resize(1);
        group.primitives.front().shape = tested_forms.front().form->shape;
    }
    for (Primitive<double>& primitive : group.primitives)
        if (has_matrices) primitive.transform = selection::placeholder_matrix();
    group.march = request.march;

    return metric_set.adapt_to_forms(selection::with_default_metrics(drawn_metrics, request.tested_forms),
                                     measure::evaluate::forms_of(tested_forms),
                                     [&group] { return measure::attribution::OwnedSetting(group); });
}

/// Prints a note on stderr if the decimals of a file do not fit its format.
void note_digits(const std::string& file, const Format& format, const JudgeResult& result) {
    const auto digits_for = [](const Format& stored) { return scene::ray_file::NumberParser(stored).digits(); };
    const Format narrow = *find_format("f32");
    const bool is_wide = format.parameters.precision > binary32.precision;
    // A program that prints the shortest decimal of each number may never need the largest number of digits. A file
    // that is one digit short is therefore not reported.
    const bool is_short = result.inexact_decimal_count > 10 && result.max_digits + 1 < digits_for(format);
    if (is_wide && result.nonzero_answer_count > 10 && result.float_answer_count == result.nonzero_answer_count &&
        !(is_short && result.max_digits < digits_for(narrow)))
        fmt::print(stderr,
                   "lostbits: {}: every t of the {} reported hits is a float, or the decimal of one, but was judged as "
                   "{}; if the answers were computed in float, add --answer-format f32\n",
                   file, result.nonzero_answer_count, format.name);
    else if (is_short)
        fmt::print(
            stderr,
            "lostbits: {}: its numbers have at most {} digits, but {} needs {}{}; bits that were not printed count as "
            "lost: print with %.{}g (std::setprecision({}))\n",
            file, result.max_digits, format.name, digits_for(format),
            is_wide ? fmt::format(" (f32 needs {})", digits_for(narrow)) : "", digits_for(format), digits_for(format));
}

/// Indices of the metrics that count hits that fail --bits or --tolerance, each with the title of its column.
std::vector<std::pair<std::size_t, const char*>> find_requirements(const JudgeRequest& request) {
    std::vector<std::pair<std::size_t, const char*>> requirements;
    for (const auto& [metric, title] : {std::pair("enough_bits", "too few"), std::pair("tolerance", "beyond")}) {
        const std::size_t index = measure::metric::index_of(request.metrics, metric);
        if (index < request.metrics.size()) requirements.emplace_back(index, title);
    }
    return requirements;
}

void print_results(const JudgeRequest& request, const JudgeResult& result, const std::string& group_column) {
    const std::size_t lost_bits = measure::metric::index_of(request.metrics, "lost_bits");
    const auto requirements = find_requirements(request);
    std::vector<shell::TextColumn> columns{{"form", 28, true}, {"fmt", 5, true}, {"hits", 8}};
    if (request.mesh) add_mesh_columns(columns);
    add_wrong_columns(columns);
    columns.insert(columns.end(), {{"bits lost: p50", 15}, {"p99", 6}, {"max", 6}});
    for (const auto& [metric, title] : requirements) columns.push_back({title, 11});
    shell::TextTable table(std::move(columns));

    using measure::contract::AnswerSource;
    const auto add_row = [&](std::string name, std::string_view format, const measure::evaluate::FormSummary& summary,
                             AnswerSource source) {
        std::vector<std::string> cells{std::move(name), std::string(format),
                                       std::to_string(summary.count(Outcome::agree_hit))};
        if (request.mesh) add_mesh_cells(cells, summary, source);
        add_wrong_cells(cells, summary);
        for (const double q : {0.5, 0.99, 1.0}) cells.push_back(lost_bits_cell(summary, lost_bits, q));
        for (const auto& [metric, title] : requirements)
            cells.push_back(std::to_string(summary.categories[metric].at(1)));
        table.add(std::move(cells));
    };

    // Below each row come the groups of --by.
    for (std::size_t r = 0; r < result.summaries.size(); ++r) {
        const auto source =
            request.is_file_form(request.tested_forms[r]) ? AnswerSource::file : AnswerSource::intersector;
        add_row(std::string(request.tested_forms[r].form->info->name), request.tested_forms[r].format.name,
                result.summaries[r], source);
        for (const measure::evaluate::Group& group : result.groups.all())
            add_row(fmt::format("  {} {}", group_column, group.value), "", group.summaries[r], source);
    }
    table.print();
}

/// The tested forms to judge: first the answers of the file, if it has some, then the forms of -i. Prints a note if
/// external intersectors were loaded but -i names no form.
std::vector<measure::evaluate::TestedForm> select_tested_forms(const JudgeOptions& options, const RayFile& ray_file,
                                                               const selection::ShapePredicate& can_test,
                                                               const intersect::table::Intersector* answers,
                                                               const CommonOptions& common) {
    std::vector<measure::evaluate::TestedForm> tested_forms;
    if (answers) tested_forms.push_back({answers, ray_file.format()});

    // Without -i only the answers of the file are judged.
    if (options.forms.empty()) {
        if (!options.formats.empty())
            throw InputError(fmt::format(
                "-f {}: is for forms, and -i names none; for the format of the answers write --answer-format",
                options.formats[0]));
        const bool has_external_forms = !common.external.plugins.empty() || !common.external.pipes.empty() ||
                                        !common.external.shaders.empty() || !common.external.functions.empty();
        if (!tested_forms.empty() && has_external_forms && !common.quiet)
            fmt::print(stderr, "lostbits: only the answers of the file are judged; add -i to judge forms too\n");
        if (!tested_forms.empty()) return tested_forms;
        throw NothingSelected(fmt::format(
            "{}: has rays but no answers (columns hit or t); name forms to judge, such as -i '{}'", options.file,
            selection::patterns_for([&can_test](Shapes s) { return selection::are_primitives(s) && can_test(s); })));
    }

    const auto formats =
        options.formats.empty() ? std::vector{ray_file.format()} : selection::select_formats(options.formats);
    auto candidates = selection::pair_forms_with_formats(selection::select_forms(options.forms), formats);
    selection::require_no_generators(candidates, "judge");
    const auto handling_forms =
        selection::tested_forms_handling({candidates, options.forms, common.quiet}, options.file, can_test);
    if (handling_forms.empty())
        throw NothingSelected(options.file + ": no selected form handles its primitives" +
                              selection::forms_advice(candidates, can_test));
    tested_forms.insert(tested_forms.end(), handling_forms.begin(), handling_forms.end());
    return tested_forms;
}

/// Findings of a judgement of a file, with the worst rays of each row.
struct JudgeFindings {
    JudgeResult result = {};
    std::vector<measure::judge::WorstRays> worst = {};
    measure::truth::StageCounts stages = {};
};
LOSTBITS_FIELDS(JudgeFindings, result, worst, stages)

/// Judges the rays of a file. A shard judges its part of them and returns nothing; a run that joins shards adds up
/// their findings.
std::optional<JudgeResult> judge_rays(RayFile& ray_file, JudgeRequest& request, output::judge::JudgeWriter& writer,
                                      shard::Division& division,
                                      const std::function<std::unique_ptr<RayFile>()>& open_again) {
    request.pieces = division.units_of_shard([&] { return measure::judge::count_pieces(*open_again(), request); });
    auto findings = shard::result_with_files(
        JudgeFindings{.worst = writer.worst()}, writer, division, "judge", [&]() -> JudgeFindings {
            JudgeResult result = measure::judge::run_judge(
                ray_file, request, [&writer](std::size_t form_index, const auto& chunk, const auto& band) {
                    writer.add_piece(form_index, chunk, band);
                });
            return {std::move(result), writer.worst(), *request.stages};
        });
    if (!findings) return std::nullopt;
    if (division.joins()) {
        writer.append(std::move(findings->worst));
        measure::judge::require_ray_count(ray_file, request, findings->result);
    }
    *request.stages = findings->stages;
    return std::move(findings->result);
}

/// Adds the primitives that all rays share to the request, with the numbers of the file's format. Returns the few that
/// stand for all of them, see `representatives_of`.
std::vector<Primitive<double>> add_primitives(JudgeRequest& request, const JudgeOptions& options,
                                              const std::optional<scene::file::Scene>& scene, RayFile& ray_file) {
    request.primitives = selection::shared_primitives(options, scene, ray_file.format());
    if (scene) request.mesh = scene::rays::make_stored_mesh(*scene, ray_file.format().parameters);
    if (scene && scene->march) request.march = scene::file::round_march(*scene->march, binary32);
    auto representatives = scene::rays::representatives_of(request.primitives, request.mesh.get());
    selection::transform_by_records(ray_file, representatives);
    return representatives;
}

std::unique_ptr<RayFile> open_judged_file(const JudgeOptions& options, const std::optional<scene::file::Scene>& scene) {
    return selection::open_file(options, options.file, selection::shared_shape(options, scene),
                                options.writes_rows || !options.by.empty());
}

/// The contract by which the answers of the file are judged. Throws InputError for one that the shape cannot have.
intersect::Info read_contract(const JudgeOptions& options, const RayFile& ray_file, Shapes shapes, Shape first_shape) {
    intersect::Info contract = selection::answer_contract(options, ray_file);
    if (ray_file.layout().has_only_decisions()) contract.roots = intersect::Roots::none;
    intersect::external::require_valid_facing(contract.facing, first_shape, options.file);
    if (!shapes.are_several())
        intersect::refuse_unused_at_origin(contract.at_origin, contract.inside, first_shape, options.file);
    return contract;
}

/// Compares every row with the form of --against. Throws InputError if that form does not fit the file.
void compare_with_form(const JudgeOptions& options, const RayFile& ray_file, const selection::ShapePredicate& can_test,
                       JudgeRequest& request, bool quiet) {
    const auto against_forms = selection::select_forms({options.against}, "--against");
    const auto mixed_shapes = selection::several_shapes(can_test);
    if (mixed_shapes && !(against_forms.front()->shapes() == *mixed_shapes))
        throw InputError(fmt::format("--against {}: {}{}", options.against, options.file,
                                     selection::forms_advice({{against_forms.front(), ray_file.format()}}, can_test)));
    selection::compare_against(request.tested_forms, options.against, quiet);
    // The comparison drops rows in formats that the form does not have.
    if (request.file_answers_form && !request.file_form_index())
        throw InputError(
            fmt::format("--against {}: this form does not exist in {}, the format of {}; name a form that does, or "
                        "--answer-format",
                        options.against, ray_file.format().name, options.file));
}

/// The size of the picture: that of --size, or of the array in the file. Throws InputError for a bad one.
std::optional<std::pair<int, int>> select_picture_size(const JudgeOptions& options, const RayFile& ray_file) {
    const auto size = options.size.empty() ? ray_file.picture() : selection::parse_size(options.size);
    const auto [width, height] = size.value_or(std::pair(1, 1));
    if (std::min(width, height) < 1 || std::max(width, height) > 65536)
        throw InputError(
            options.size.empty()
                ? fmt::format("{}: its array has {} x {} rays, but a picture has at most 65536 pixels per "
                              "side; give the size of the picture by --size WxH",
                              options.file, width, height)
                : fmt::format("--size {}: width and height are whole numbers from 1 to 65536", options.size));
    if (options.pictures == "all" && !size)
        throw InputError("--pictures all: a list of rays is not a picture; give its columns and rows by --size WxH");
    return size;
}

/// Sets the metrics of the request. Returns those to draw.
std::vector<const Metric*> add_metrics(JudgeRequest& request, const JudgeOptions& options, const RayFile& ray_file,
                                       measure::metric::MetricSet& metric_set, bool quiet) {
    auto drawn_metrics = options.metrics.empty() ? std::vector{measure::metric::find_metric("lost_bits")}
                                                 : selection::select_metrics(options.metrics, metric_set);
    drawn_metrics = selection::applicable_metrics(drawn_metrics, request.tested_forms, options.file);
    if (!options.against.empty()) selection::add_comparison_metrics(drawn_metrics);
    selection::note_forms_without_formula(drawn_metrics, request.tested_forms, quiet);

    auto measured_metrics = drawn_metrics;
    selection::add_requirement(options, metric_set, measured_metrics);
    request.metrics = make_metrics(measured_metrics, request, ray_file.layout().has_matrix(), metric_set);
    // The metrics of the request are made for its forms, so these are drawn.
    for (const Metric*& m : drawn_metrics) m = request.metrics[measure::metric::index_of(request.metrics, m->name)];
    return drawn_metrics;
}

RunDivision divide_judgement(const JudgeOptions& options, const std::optional<scene::file::Scene>& scene,
                             const CommonOptions& common) {
    std::vector<std::filesystem::path> input_files{options.file};
    if (scene) input_files.push_back(scene->path);
    RunDivision run_division = divide_run(options.shard, options.out, input_files, common);
    run_division.division.require_same_jobs({"judge"});
    return run_division;
}

output::judge::JudgeWriterOptions make_files_options(const JudgeOptions& options, const std::filesystem::path& folder,
                                                     const std::string& id, const std::string& command) {
    return {.folder = folder,
            .id = id,
            .title = "rays of " + std::filesystem::path(options.file).filename().string(),
            .command = command,
            .draws_single_pictures = options.pictures == "all",
            .writes_rows = options.writes_rows,
            .worst_count = options.worst_count};
}

void print_judgement(const JudgeOptions& options, const JudgeRequest& request, const JudgeResult& result,
                     const Format& format, bool verbose) {
    selection::warn_of_rounded_values(options.file, result.rounded_count, format);
    note_digits(options.file, format, result);
    fmt::print("{} of {}, read as {}\n", text::count_with_noun(result.ray_count, "ray"), options.file, format.name);
    print_results(request, result, options.by);
    print_comparisons(request.tested_forms, request.metrics, result.summaries);
    if (verbose) print_stages(*request.stages);
}

/// Prints on stderr what seems to be wrong with the answers of the file.
void note_suspicious_answers(const JudgeOptions& options, const JudgeRequest& request, const JudgeResult& result,
                             const CommonOptions& common) {
    const auto file_form = request.file_form_index();
    if (!file_form) return;
    note_suspicions({request.tested_forms[*file_form]}, common, [&](const measure::evaluate::TestedForm&) {
        const std::string suspicion_text =
            measure::contract::suspicion_text(result.first_samples, measure::contract::AnswerSource::file,
                                              result.scaled_right_misses(result.summaries[*file_form]));
        const bool is_whole_file = result.has_all_samples(result.summaries[*file_form]);
        return measure::contract::name_counted_rays(
            options.file, is_whole_file ? result.ray_count : result.first_samples.size(), result.ray_count,
            "of its rays that hit or should hit", suspicion_text);
    });
}

ExitStatus run(const JudgeOptions& options, const CommonOptions& common) {
    require_folder(options.out);
    const auto scene = selection::load_scene_of_rays(options, selection::data_folder(common.data));
    const auto ray_file = open_judged_file(options, scene);
    if (ray_file->layout().answer_kind() > scene::ray_file::AnswerKind::first_hit)
        return run_mesh_judge(options, scene, *ray_file, common);

    JudgeRequest request{.limit = {.stop = common.stop}};
    const auto representatives = add_primitives(request, options, scene, *ray_file);
    const Shapes shapes = selection::shapes_of_rays(ray_file->layout(), representatives);
    const Shape first_shape =
        ray_file->layout().primitive_shape() ? *ray_file->layout().primitive_shape() : representatives.front().shape;
    const selection::ShapePredicate can_test = [&](Shapes forms) {
        return forms == shapes || (forms == Shape::sdf && request.march.has_value());
    };

    // The rows: the answers of the file, and the forms of -i.
    const std::string stem = scene::toml::result_name(options.file);
    const measure::judge::FileForm answers(stem, first_shape, read_contract(options, *ray_file, shapes, first_shape));
    if (ray_file->layout().has_first_hits()) request.file_answers_form = &answers.form();
    request.group_column = selection::group_column(options, ray_file->layout());
    request.tested_forms = select_tested_forms(options, *ray_file, can_test, request.file_answers_form, common);
    if (!options.forms.empty()) selection::note_unmeasured(options.forms, request.tested_forms, common.quiet);
    if (!options.against.empty()) compare_with_form(options, *ray_file, can_test, request, common.quiet);

    request.picture = select_picture_size(options, *ray_file);
    measure::metric::MetricSet metric_set;
    const auto drawn_metrics = add_metrics(request, options, *ray_file, metric_set, common.quiet);
    measure::truth::StageCounts stages;
    request.stages = &stages;

    const selection::ThreadLimit limit(common.threads);
    const bool counts_bytes = ray_file->bytes() > 0;
    output::file::Progress progress(counts_bytes ? ray_file->bytes() : 1, "judge", common.progress, common.quiet);
    const auto advance = advance_callback(progress);
    request.progress = [&](std::uint64_t, std::uint64_t bytes) { advance(counts_bytes ? bytes : 0); };

    RunDivision run_division = divide_judgement(options, scene, common);
    const auto folder = std::filesystem::path(options.out) / stem;
    const auto result_folder = lock_folder(run_division, folder, common, text::shell_word(options.file));
    output::judge::JudgeWriterOptions files_options =
        make_files_options(options, folder, stem, common.typed_command.text());
    if (request.picture) files_options.drawn_metrics = drawn_metrics;
    files_options.keep_piece = shard::piece_recorder(run_division.division, "judge");
    output::judge::JudgeWriter writer(request, *ray_file, std::move(files_options));
    const auto judgement =
        judge_rays(*ray_file, request, writer, run_division.division, [&] { return open_judged_file(options, scene); });
    finish_run(run_division, common);
    if (!judgement) {
        progress.finish();
        return ExitStatus::done;
    }

    const bool wrote_worst_rays = writer.finish(*judgement);
    complete_folder(result_folder);
    progress.finish();
    if (!common.quiet) {
        print_judgement(options, request, *judgement, ray_file->format(), common.verbose);
        if (request.picture) print_figure_paths(folder / "contact.png");
        else fmt::print("{}\n", (folder / "summary.csv").string());
        if (wrote_worst_rays) fmt::print("{}\n", (folder / "worst.toml").string());
    }
    note_suspicious_answers(options, request, *judgement, common);
    return report_unproved(judgement->summaries.front().count(Outcome::unresolved));
}

}  // namespace

void add_judge(const shell::Command& program, const CommonOptions& common) {
    auto command = program.add_command(
        "judge", "Judge the answers in a file of rays, or let forms answer the same rays and judge them");
    const auto options = std::make_shared<JudgeOptions>();
    options->stop = common.stop;
    command
        .add("FILE", options->file,
             "A file of rays (CSV, .npy or raw) with columns such as ox,oy,oz,dx,dy,dz,hit,t (docs/judge.md)")
        .required();
    selection::add_ray_options(command, *options);

    // Answers to judge, and how.
    command.add_list("-i,--form", options->forms, "Forms to run on the same rays, by name or glob");
    command.add_list("-f,--form-format", options->formats, "Formats of these forms (default: the format of the file)");
    command.add("--against", options->against, "Also compare the answers with those of this form");
    command.add_list("--metric", options->metrics,
                     "Metrics to measure, by name or glob (default: lost_bits); see `lostbits list metrics`");
    command.add("--by", options->by,
                "Also write results for each value of a column of your own, such as depth or material");
    command.add("--bits", options->bits, "Correct bits of t that a hit must keep: count the hits that keep fewer",
                shell::number_between(0, 53));
    command.add(
        "--tolerance", options->tolerance,
        "Distance that a hit may be from the true point, along the ray, in the scene's unit of length: count the hits "
        "that are farther");
    command.add("--unit", options->unit, "The scene's unit of length (m, km, cm, mm, um, in, ft), for --tolerance 1mm");

    // Outputs.
    command.add("--size", options->size, "Draw the rays as a picture of WxH pixels, row by row");
    selection::add_pictures(command, options->pictures);
    command.add("--rows", options->writes_rows, "Also write one row per ray, with the columns of the file");
    command.add(
        "--worst-rays", options->worst_count,
        "Number of rays of each kind in worst.toml: correct hits with the largest errors, and each kind of wrong "
        "decision (default: 10)");
    add_shard(command, options->shard);
    selection::add_out(command, options->out);
    command.set_action([options, &common] { return run(*options, common); });
}

}  // namespace lostbits::analysis
