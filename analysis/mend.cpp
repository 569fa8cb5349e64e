#include "measure/repair/repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <regex>

#include "analysis/report/report_parts.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "commands.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/file/atomic_file.hpp"
#include "output/repair/repair_files.hpp"

namespace lostbits::analysis {

using measure::repair::RepairRequest;
using output::repair::RepairSummary;

namespace {

struct MendOptions {
    std::vector<std::string> subjects;  ///< one scene, or files of rays
    selection::SceneChoice changes;
    selection::RayFileOptions rays;
    std::string form, format = "f32", wider = "double", at = "max", out, emit, compiler = "c++";
    bool price = false;
    double bits = 0, wrong = 0;
};

/// The form and format to repair. Throws an error if the form is not for the primitives of `id`.
measure::evaluate::TestedForm row_of(const MendOptions& o, const std::string& id,
                                     const selection::ShapePredicate& meets) {
    const auto forms = selection::select_forms({o.form});
    const auto formats = selection::select_formats({o.format});
    if (std::ranges::any_of(formats, selection::is_emulated))
        throw InputError(fmt::format("-f {}: mend works in f32 and f64 only; name one of them", o.format));
    if (forms.size() != 1 || formats.size() != 1)
        throw InputError(
            fmt::format("-i {}, -f {}: mend repairs one form in one format; name one of each", o.form, o.format));
    if (!forms.front()->exists_in(formats.front()))
        throw InputError(fmt::format("-f {}: {} does not exist in this format; its formats: {}", o.format, o.form,
                                     selection::formats_of(*forms.front())));
    selection::refuse_generators(forms, "mend");
    const auto* form = forms.front();
    if (meets(form->shapes().placed()) && is_primitive(form->shape) && !form->is_placed)
        form = &intersect::transform::through(intersect::transform::usual_transform_method(), *form);
    if (!meets(form->shapes()))
        throw NothingSelected(fmt::format("{} is not a form for the primitives of {}{}", o.form, id,
                                          selection::fitting_forms_advice({{form, *find_format(o.format)}}, meets)));
    return {.form = form, .format = formats.front()};
}

/// Times the form, its repairs and the catalogue in one run. If nothing can be compiled, records the reason.
void add_prices(RepairSummary& result, const MendOptions& o, const std::string& command) {
    const RepairRequest& request = result.request;
    std::vector<measure::repair::RepairedSource> sources;
    const auto proposals = proposals_of(result);
    for (const auto& proposal : proposals) {
        const std::string name = fmt::format("mended{}", sources.size() + 1);
        sources.push_back(output::repair::written(result, proposal, name, command));
    }
    try {
        std::vector<intersect::external::Formula> formulas;
        if (!sources.empty())
            formulas = compile_and_load(request, sources, {o.compiler, selection::form_flags_folder()});
        std::vector<measure::evaluate::TestedForm> rows{request.row};
        for (const auto& formula : formulas) rows.push_back({.form = &formula.row, .format = request.row.format});
        rows.insert(rows.end(), result.catalogue.begin(), result.catalogue.end());
        result.prices = measure_prices(request, rows, {.stop = request.limit.stop});
    } catch (const EnvironmentError& error) {
        result.no_price = error.what();
    }
}

std::string command_of(const MendOptions& o) {
    using output::attribution::shell_word;
    std::string command = fmt::format("lostbits mend {} -i {} -f {} --bits {:.12g}", shell_word(o.subjects.front()),
                                      shell_word(o.form), shell_word(o.format), o.bits);
    const auto add = [&command](const char* option, const std::string& value) {
        command += fmt::format(" {} {}", option, shell_word(value));
    };
    if (o.wrong != 0) command += fmt::format(" --wrong {:.12g}", o.wrong);
    if (o.at != "max") add("--at", o.at);
    if (o.wider != "double") add("--wider", o.wider);
    if (!o.changes.size.empty()) add("--size", o.changes.size);
    if (!o.changes.variant.empty()) add("--variant", o.changes.variant);
    for (const std::string& change : o.changes.set) add("--set", change);
    return command;
}

void write_page(const std::filesystem::path& path, const RepairSummary& result, const std::string& command) {
    output::page::Report report{
        .command = command, .maps = {}, .sweeps = {}, .trades = {}, .claims = {}, .results = {}};
    report.program = "lostbits " LOSTBITS_VERSION;
    report.mends.push_back(report::mend_part(result));
    if (report.mends.front().timed) report.processor = measure::speed::processor_name();
    output::file::write_file(path, output::page::page(report));
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
    RayFiles(const MendOptions& o, const Common& common) : o_(o), common_(common), opened_(open()) {}
    [[nodiscard]] const std::string& id() const { return opened_.id; }
    [[nodiscard]] const std::string& quoted_files() const { return opened_.quoted_files; }
    [[nodiscard]] Shapes shapes() const { return opened_.shapes; }

    /// Makes these files the subject of the request.
    void set_subject_of(RepairRequest& request) {
        rays_ = judge(request, measure::repair::comparable_forms(request.row));
        if (!common_.quiet) selection::note_rounded(rays_.name, rays_.rounded, rays_.format);
        request.rays = &rays_;
        request.quality_on_all_rays = [this, &request](const std::vector<Tape>& tapes) {
            std::deque<measure::tape::TapeForm> forms;
            std::vector<measure::evaluate::TestedForm> rows;
            for (const Tape& tape : tapes) {
                forms.emplace_back(*request.row.form, request.row.format, tape, "mended", "");
                rows.push_back({.form = &forms.back().row(), .format = request.row.format});
            }
            opened_ = open();
            return judge(request, rows).quality;
        };
    }

private:
    [[nodiscard]] selection::OpenedRays open() const {
        return selection::open_rays(o_.rays, o_.subjects, selection::data_folder(common_.data));
    }
    measure::choice::FileRays judge(const RepairRequest& request,
                                    const std::vector<measure::evaluate::TestedForm>& rows) {
        measure::choice::ChoiceRequest choice_request{.rows = rows, .requirement = request.requirement};
        choice_request.limit = request.limit;
        return judge_rays(*opened_.dump, opened_.terms, choice_request);
    }

    const MendOptions& o_;
    const Common& common_;
    selection::OpenedRays opened_;
    measure::choice::FileRays rays_ = {};
};

scene::file::Scene scene_of(const MendOptions& o, const std::filesystem::path& data) {
    selection::SceneChoice choice = o.changes;
    choice.names = o.subjects;
    scene::file::Scene scene = selection::load_one_scene(choice, data);
    selection::refuse_generated_rays({scene}, "mend");
    return scene;
}

Exit run(const MendOptions& o, const Common& common) {
    if (!o.emit.empty()) require_code_name(o.emit, o.out);
    if (!o.out.empty()) require_folder(o.out);
    selection::refuse_others(o.rays, o.subjects,
                             {{"--size", !o.changes.size.empty()},
                              {"--variant", !o.changes.variant.empty()},
                              {"--set", !o.changes.set.empty()}},
                             "mending");
    const auto data = selection::data_folder(common.data);
    std::optional<scene::file::Scene> scene;
    std::optional<RayFiles> rays;
    if (selection::are_files(o.rays, o.subjects)) rays.emplace(o, common);
    else scene = scene_of(o, data);
    const auto meets = [&](Shapes forms) { return scene ? scene->meets(forms) : forms == rays->shapes(); };
    RepairRequest request{.scene = scene ? &*scene : nullptr,
                          .row = row_of(o, scene ? scene->id : rays->id(), meets),
                          .two_words = o.wider == "two-words"};
    if (o.emit.ends_with(".glsl") && request.row.format.engine == Format::Engine::native64)
        throw InputError("--emit " + o.emit +
                         ": shaders compute in f32; write -f f32, or a file name that ends in "
                         ".hpp");
    if (o.emit.ends_with(".glsl") && request.row.form->is_placed)
        throw InputError("--emit " + o.emit +
                         ": a shader cannot be written for a form with a transform; write --emit NAME.hpp, or mend the "
                         "form without its transform, -i " +
                         std::string(intersect::bounding_box::innermost(*request.row.form).info->name));
    request.requirement = {.bits = o.bits, .wrong = o.wrong, .quantile = parse_quantile(o.at)};
    request.limit.stop = common.stop;
    const selection::ThreadLimit limit(common.threads);
    if (rays) rays->set_subject_of(request);
    const std::string subject = scene ? selection::name_of_scene(*scene, data) : rays->quoted_files();
    std::unique_ptr<output::file::ResultFolder> result_folder;
    std::optional<output::repair::RepairFiles> files;
    if (!o.out.empty()) {
        const auto folder = std::filesystem::path(o.out) / request.id();
        result_folder = take_folder(folder, common, subject);
        files.emplace(folder);
    }
    std::optional<output::file::AtomicFile> header;
    if (!o.emit.empty()) header.emplace(o.emit);
    const measure::repair::RepairResult repair = repair_form(request);
    RepairSummary result = output::repair::result_of(request, repair);
    const std::string command = scene ? command_of(o) : common.typed_command.for_subject(subject);
    if (o.price) add_prices(result, o, command);
    if (header) {
        header->write(emitted(result, o.emit, command));
        header->commit();
    }
    if (files) {
        files->finish(result);
        write_page(files->folder() / "index.html", result, common.typed_command.for_subject(subject) + " -o out");
    }
    complete_folder(result_folder);
    fmt::print("{}", output::repair::in_words(result));
    if (files && !common.quiet)
        for (const char* name : {"mend.csv", "index.html"}) fmt::print("{}\n", (files->folder() / name).string());
    const bool meets_requirement = repair.wider_set || best_of(proposals_of(result), result);
    return meets_requirement ? Exit::done : Exit::answer_is_no;
}

}  // namespace

void add_mend(const shell::Command& program, const Common& common) {
    auto command = program.add_command("mend",
                                       "Find what to change in a form so that it meets a requirement on a scene or on "
                                       "rays of files");
    const auto o = std::make_shared<MendOptions>();
    o->changes.stop = o->rays.stop = common.stop;
    command.add("SCENE", o->subjects, "A scene file, a name in data/scenes, or files of rays as for `lostbits judge`")
        .required();
    command.add("-i,--form", o->form, "The form to mend").required();
    command.add("-f,--format", o->format, "f32 (default) or f64");
    command
        .add("--bits", o->bits,
             "The correct bits of t that the form is to keep, for the share of the hits that --at gives",
             shell::number_from(0, 53))
        .required();
    command.add("--wrong", o->wrong, "Share of the rays that may be decided wrongly (default: 0)",
                shell::number_from(0, 1));
    command.add("--at", o->at,
                "Share of the hits that must keep the bits: p50, p99, p99.9, or max for all hits (default)");
    command.add("--wider", o->wider, "Arithmetic of the wider operations (default: double; docs/mend.md)",
                shell::one_of({"double", "two-words"}));
    selection::add_changes(command, o->changes, "sphere[0].radius=10");
    selection::add_ray_options(command, o->rays);
    command.add("--price", o->price, "Compile the changed forms and time them beside the form and the catalogue");
    command.add("--compiler", o->compiler, "The compiler that --price uses (default: c++)");
    command.add("--emit", o->emit,
                "Also write the changed form as C++ (NAME.hpp), GLSL (NAME.glsl) or a patch of your file (NAME.patch)");
    command.add("-o,--out", o->out, "Folder for the results");
    command.runs([o, &common] { return run(*o, common); });
}

}  // namespace lostbits::analysis
