#include "measure/repair/repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <regex>

#include "analysis/report/report_sections.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "commands.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/file/atomic_file.hpp"
#include "output/repair/repair_files.hpp"
#include "text/shell_word.hpp"

namespace lostbits::analysis {

using measure::repair::RepairRequest;
using output::repair::RepairSummary;

namespace {

struct MendOptions {
    std::vector<std::string> subjects;  ///< one scene, or files of rays
    selection::SceneOptions changes;
    selection::RayFileOptions rays;
    std::string form, format = "f32", wider = "double", at = "max", out, emit, compiler = "c++";
    bool price = false;
    double bits = 0, wrong = 0;
};

/// The form and format to repair. Throws an error if the form is not for the primitives of `id`.
measure::evaluate::TestedForm select_tested_form(const MendOptions& options, const std::string& id,
                                                 const selection::ShapePredicate& can_test) {
    const auto forms = selection::select_forms({options.form});
    const auto formats = selection::select_formats({options.format});
    if (std::ranges::any_of(formats, &Format::is_emulated))
        throw InputError(fmt::format("-f {}: mend works in f32 and f64 only; name one of them", options.format));
    if (forms.size() != 1 || formats.size() != 1)
        throw InputError(fmt::format("-i {}, -f {}: mend repairs one form in one format; name one of each",
                                     options.form, options.format));
    if (!forms.front()->exists_in(formats.front()))
        throw InputError(fmt::format("-f {}: {} does not exist in this format; its formats: {}", options.format,
                                     options.form, selection::formats_text(*forms.front())));
    selection::require_no_generators(forms, "mend");

    // For transformed primitives, the form gets the usual transform method.
    const auto* form = forms.front();
    if (can_test(form->shapes().with_transform()) && is_primitive(form->shape) && !form->has_transform_method)
        form = &intersect::transform::transformed_form(intersect::transform::default_transform_method(), *form);
    if (!can_test(form->shapes()))
        throw NothingSelected(fmt::format("-i {}: is not a form for the primitives of {}{}", options.form, id,
                                          selection::forms_advice({{form, *find_format(options.format)}}, can_test)));
    return {.form = form, .format = formats.front()};
}

/// Times the form, its repairs and the catalogue in one run. If nothing can be compiled, records the reason.
void add_prices(RepairSummary& result, const MendOptions& options, const std::string& command) {
    const RepairRequest& request = result.request;
    // Writes each repair as source code.
    std::vector<measure::repair::RepairedSource> sources;
    const auto proposals = list_proposals(result);
    for (const auto& proposal : proposals) {
        const std::string name = fmt::format("mended{}", sources.size() + 1);
        sources.push_back(output::repair::make_repaired_source(result, proposal, name, command));
    }
    try {
        std::vector<intersect::external::Formula> formulas;
        // A compiler is needed only if something was repaired.
        if (!sources.empty())
            formulas = compile_and_load(request, sources, {options.compiler, selection::form_flags_folder()});
        std::vector<measure::evaluate::TestedForm> tested_forms{request.tested_form};
        for (const auto& formula : formulas)
            tested_forms.push_back({.form = &formula.intersector, .format = request.tested_form.format});
        tested_forms.insert(tested_forms.end(), result.catalogue.begin(), result.catalogue.end());
        result.prices = measure_prices(request, tested_forms, {.stop = request.limit.stop});
    } catch (const EnvironmentError& error) {
        result.no_price_reason = error.what();
    }
}

std::string mend_command(const MendOptions& options) {
    using text::shell_word;
    std::string command =
        fmt::format("lostbits mend {} -i {} -f {} --bits {:.12g}", shell_word(options.subjects.front()),
                    shell_word(options.form), shell_word(options.format), options.bits);
    const auto add = [&command](const char* option, const std::string& value) {
        command += fmt::format(" {} {}", option, shell_word(value));
    };
    if (options.wrong != 0) command += fmt::format(" --wrong {:.12g}", options.wrong);
    if (options.at != "max") add("--at", options.at);
    if (options.wider != "double") add("--wider", options.wider);
    if (!options.changes.size.empty()) add("--size", options.changes.size);
    if (!options.changes.variant.empty()) add("--variant", options.changes.variant);
    for (const std::string& change : options.changes.set) add("--set", change);
    return command;
}

void write_page(const std::filesystem::path& path, const RepairSummary& result, const std::string& command) {
    output::report::Report report{
        .command = command, .maps = {}, .sweeps = {}, .trades = {}, .claims = {}, .results = {}};
    report.program = "lostbits " LOSTBITS_VERSION;
    report.mends.push_back(report::make_mend_section(result));
    if (report.mends.front().has_times) report.processor = measure::trade::read_processor_name();
    output::file::write_file(path, output::report::page(report));
}

/// Throws InputError for a file name that is neither NAME.patch nor an identifier with .hpp or .glsl: the form, and its
/// struct or function, get that name. Also throws InputError if the folder of the file does not exist, unless it is
/// `out`, the only folder that mend creates.
void require_code_name(const std::filesystem::path& path, const std::filesystem::path& out) {
    static const std::regex identifier("[A-Za-z][A-Za-z0-9_]*");
    const bool is_patch = path.extension() == ".patch";
    const bool has_known_extension = path.extension() == ".hpp" || path.extension() == ".glsl" || is_patch;
    if (!has_known_extension || (!is_patch && !std::regex_match(path.stem().string(), identifier)))
        throw InputError("--emit " + path.string() +
                         ": the form gets the name of the file; write a name of letters, digits and _ with .hpp, "
                         ".glsl or .patch, as in half_b_mended.hpp");
    const auto folder = path.parent_path();
    const bool is_out_folder = !out.empty() && folder.lexically_normal() == (out / "").lexically_normal().parent_path();
    if (!folder.empty() && !is_out_folder && !std::filesystem::is_directory(folder))
        throw InputError(
            fmt::format("--emit {}: the folder {} does not exist; create it, or name "
                        "another",
                        path.string(), folder.string()));
}

/// Files of rays. Forms can be judged on all rays of the files, as often as needed.
class RayFiles {
public:
    RayFiles(const MendOptions& options, const CommonOptions& common)
        : options_(options), common_(common), opened_(open()) {}
    [[nodiscard]] const std::string& id() const { return opened_.id; }
    [[nodiscard]] const std::string& quoted_files() const { return opened_.quoted_files; }
    [[nodiscard]] Shapes shapes() const { return opened_.shapes; }

    /// Makes these files the subject of the request.
    void set_subject_of(RepairRequest& request) {
        rays_ = judge(request, measure::repair::list_comparable_forms(request.tested_form));
        if (!common_.quiet)
            selection::warn_of_rounded_values(rays_.typed_file_names, rays_.rounded_count, rays_.format);
        request.rays = &rays_;
        request.quality_on_all_rays = [this, &request](const std::vector<Tape>& tapes) {
            std::deque<measure::tape::TapeForm> forms;
            std::vector<measure::evaluate::TestedForm> tested_forms;
            for (const Tape& tape : tapes) {
                forms.emplace_back(*request.tested_form.form, request.tested_form.format, tape, "mended", "");
                tested_forms.push_back({.form = &forms.back().form(), .format = request.tested_form.format});
            }
            opened_ = open();
            return judge(request, tested_forms).quality;
        };
    }

private:
    [[nodiscard]] selection::OpenedRays open() const {
        return selection::open_rays(options_.rays, options_.subjects, selection::data_folder(common_.data));
    }
    measure::choose::FileRays judge(const RepairRequest& request,
                                    const std::vector<measure::evaluate::TestedForm>& tested_forms) {
        measure::choose::ChoiceRequest choice_request{.tested_forms = tested_forms, .requirement = request.requirement};
        choice_request.limit = request.limit;
        return judge_and_sample(*opened_.ray_file, opened_.options, choice_request);
    }

    const MendOptions& options_;
    const CommonOptions& common_;
    selection::OpenedRays opened_;
    measure::choose::FileRays rays_ = {};
};

scene::file::Scene load_subject_scene(const MendOptions& options, const std::filesystem::path& data) {
    selection::SceneOptions choice = options.changes;
    choice.names = options.subjects;
    scene::file::Scene scene = selection::load_one_scene(choice, data);
    selection::require_no_generated_rays({scene}, "mend");
    return scene;
}

/// The scene or the files of rays on which the form is repaired.
struct MendSubject {
    MendSubject(const MendOptions& options, const CommonOptions& common) {
        if (selection::are_ray_files(options.rays, options.subjects)) rays.emplace(options, common);
        else scene = load_subject_scene(options, selection::data_folder(common.data));
    }
    [[nodiscard]] const std::string& id() const { return scene ? scene->id : rays->id(); }
    [[nodiscard]] bool meets(Shapes forms) const { return scene ? scene->accepts(forms) : forms == rays->shapes(); }
    /// The name of the scene or of the files, quoted for a shell.
    [[nodiscard]] std::string quoted_name(const CommonOptions& common) const {
        return scene ? selection::scene_arguments(*scene, selection::data_folder(common.data)) : rays->quoted_files();
    }

    std::optional<scene::file::Scene> scene;
    std::optional<RayFiles> rays;  ///< set if `scene` is not
};

/// Throws InputError for options that do not fit the subject, and for names of files that cannot be written.
void require_compatible_options(const MendOptions& options) {
    if (!options.emit.empty()) require_code_name(options.emit, options.out);
    if (!options.out.empty()) require_folder(options.out);
    selection::require_no_misplaced_options(options.rays, options.subjects,
                                            {{"--size", !options.changes.size.empty()},
                                             {"--variant", !options.changes.variant.empty()},
                                             {"--set", !options.changes.set.empty()}},
                                            "mending");
}

/// Throws InputError if --emit asks for a shader that cannot compute the form.
void require_shader_form(const std::string& emit, const measure::evaluate::TestedForm& tested_form) {
    if (!emit.ends_with(".glsl")) return;
    if (tested_form.format.engine == Format::Engine::native64)
        throw InputError("--emit " + emit +
                         ": shaders compute in f32; write -f f32, or a file name that ends in "
                         ".hpp");
    if (tested_form.form->has_transform_method)
        throw InputError(
            "--emit " + emit +
            ": a shader cannot be written for a form with a transform method; write --emit NAME.hpp, or mend the "
            "form without its transform, -i " +
            std::string(intersect::bounding_box::innermost_form(*tested_form.form).info->name));
}

/// The request without the rays of files, which keep a reference to it.
RepairRequest make_request(const MendOptions& options, const MendSubject& subject, intersect::process::StopToken stop) {
    RepairRequest request{
        .scene = subject.scene ? &*subject.scene : nullptr,
        .tested_form = select_tested_form(options, subject.id(), [&](Shapes forms) { return subject.meets(forms); }),
        .two_words = options.wider == "two-words"};
    require_shader_form(options.emit, request.tested_form);
    request.requirement = {
        .bits = options.bits, .max_wrong_fraction = options.wrong, .quantile = parse_quantile(options.at)};
    request.limit.stop = stop;
    return request;
}

/// The files that the command writes. They are opened before the search, so that it does not run in vain.
class MendWriter {
public:
    MendWriter(const MendOptions& options, const CommonOptions& common, const std::string& subject,
               const std::string& id)
        : options_(options) {
        if (!options.out.empty()) {
            const auto folder = std::filesystem::path(options.out) / id;
            result_folder_ = lock_folder(folder, common, subject);
            files_.emplace(folder);
        }
        if (!options.emit.empty()) emitted_file_.emplace(options.emit);
    }

    /// `form_command` makes the emitted file again, `page_command` the page.
    void write(const RepairSummary& result, const std::string& form_command, const std::string& page_command) {
        if (emitted_file_) {
            emitted_file_->write(emitted_file_text(result, options_.emit, form_command));
            emitted_file_->commit();
        }
        if (files_) {
            files_->finish(result);
            write_page(files_->folder() / "index.html", result, page_command);
        }
        complete_folder(result_folder_);
    }

    void print_paths() const {
        if (!files_) return;
        for (const char* name : {"mend.csv", "index.html"}) fmt::print("{}\n", (files_->folder() / name).string());
    }

private:
    const MendOptions& options_;
    std::unique_ptr<output::file::ResultFolder> result_folder_;
    std::optional<output::repair::RepairWriter> files_;
    std::optional<output::file::AtomicFile> emitted_file_;
};

ExitStatus run(const MendOptions& options, const CommonOptions& common) {
    require_compatible_options(options);
    MendSubject subject(options, common);
    RepairRequest request = make_request(options, subject, common.stop);
    const selection::ThreadLimit limit(common.threads);
    if (subject.rays) subject.rays->set_subject_of(request);

    const std::string name = subject.quoted_name(common);
    MendWriter writer(options, common, name, request.id());
    const measure::repair::RepairResult repair = repair_form(request);
    RepairSummary result = output::repair::summarise_repair(request, repair);
    // Only a command for a scene can be made from its options.
    const std::string command = subject.scene ? mend_command(options) : common.typed_command.for_subject(name);
    if (options.price) add_prices(result, options, command);

    writer.write(result, command, common.typed_command.for_subject(name) + " -o out");
    fmt::print("{}", output::repair::repair_text(result));
    if (!common.quiet) writer.print_paths();
    const bool meets_requirement = repair.wider_set || best_proposal(list_proposals(result), result);
    return meets_requirement ? ExitStatus::done : ExitStatus::answer_is_no;
}

}  // namespace

void add_mend(const shell::Command& program, const CommonOptions& common) {
    auto command = program.add_command("mend",
                                       "Find what to change in a form so that it meets a requirement on a scene or on "
                                       "rays of files");
    const auto options = std::make_shared<MendOptions>();
    options->changes.stop = options->rays.stop = common.stop;

    // The form to repair.
    command
        .add("SCENE", options->subjects,
             "A scene file, a name in data/scenes, or files of rays as for `lostbits judge`")
        .required();
    command.add("-i,--form", options->form, "The form to mend").required();
    command.add("-f,--format", options->format, "f32 (default) or f64");

    // The requirement, and the changes that are allowed.
    command
        .add("--bits", options->bits,
             "Correct bits of t that the form must keep, for the share of the hits that --at gives",
             shell::number_between(0, 53))
        .required();
    command.add("--wrong", options->wrong, "Share of the rays that may be decided wrongly (default: 0)",
                shell::number_between(0, 1));
    command.add("--at", options->at,
                "Share of the hits that must keep the bits: p50, p99, p99.9, or max for all hits (default)");
    command.add("--wider", options->wider, "Arithmetic of the wider operations (default: double; docs/mend.md)",
                shell::one_of({"double", "two-words"}));

    // Changes of the scene, and the meaning of files of rays.
    selection::add_changes(command, options->changes, "sphere[0].radius=10");
    selection::add_ray_options(command, options->rays);

    // Outputs of the repairs.
    command.add("--price", options->price, "Compile the changed forms and time them beside the form and the catalogue");
    command.add("--compiler", options->compiler, "The compiler that --price uses (default: c++)");
    command.add("--emit", options->emit,
                "Also write the changed form as C++ (NAME.hpp), GLSL (NAME.glsl) or a patch of your file (NAME.patch)");
    command.add("-o,--out", options->out, "Folder for the results (default: none is written)");
    command.set_action([options, &common] { return run(*options, common); });
}

}  // namespace lostbits::analysis
