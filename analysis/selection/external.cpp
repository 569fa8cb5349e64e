#include "analysis/selection/external.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string_view>
#include <system_error>
#include <thread>

#include "analysis/selection/options.hpp"
#include "analysis/selection/select.hpp"
#include "intersect/device/device.hpp"
#include "intersect/external/formulas.hpp"
#include "intersect/external/guard.hpp"
#include "intersect/external/pipe.hpp"
#include "intersect/external/plugin.hpp"
#include "intersect/function/function.hpp"
#include "intersect/process/child.hpp"
#include "intersect/process/own_state.hpp"
#include "intersect/table/table.hpp"
#include "measure/tape/driver_difference.hpp"
#include "number/error.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/file/atomic_file.hpp"
#include "scene/toml/counted.hpp"
#include "scene/toml/files_of_run.hpp"

namespace lostbits::analysis::selection {

using intersect::external::ForeignForm;
using intersect::external::open_pipe;
using intersect::external::PipeTerms;
using output::attribution::shell_word;

namespace {

/// The forms of a library that is loaded in another process of this program.
std::vector<ForeignForm> isolated(const std::filesystem::path& library, PipeTerms terms) {
    terms.message_prefix = library.string() + " in a process of its own";
    terms.is_lostbits = true;
    return open_pipe(this_program("plugin serve " + shell_word(library.string())), terms);
}

/// The forms of a shader. Another process of this program holds the driver, with its compiler, its threads and its
/// faults.
std::vector<ForeignForm> served(const std::string& shader, const std::string& device, PipeTerms terms) {
    terms.message_prefix = "--shader " + shader + (device.empty() ? "" : " --device " + shell_word(device));
    terms.is_lostbits = true;
    return open_pipe(
        this_program("shader serve " + shell_word(shader) + (device.empty() ? "" : " --device " + shell_word(device))),
        terms);
}

/// The forms of a shader on each named device; for `all`, on each available one.
std::vector<ForeignForm> served_by_each(const std::string& shader, const ExternalOptions& words,
                                        const PipeTerms& terms) {
    const bool all = std::ranges::find(words.devices, "all") != words.devices.end();
    std::vector<ForeignForm> forms;
    std::string lacks;
    for (const std::string& device : devices_of(words.devices)) {
        try {
            std::ranges::move(served(shader, device, terms), std::back_inserter(forms));
        } catch (const EnvironmentError& missing) {
            if (!all) throw;
            lacks += std::string("\n  ") + missing.what();
        }
    }
    if (forms.empty()) throw EnvironmentError("--device all: no driver can run shaders here:" + lacks);
    return forms;
}

/// True if a library exports formulas: it has `lostbits_formulas` in its table of names. Runs no code of the library.
bool has_formulas(const std::filesystem::path& library) {
    std::ifstream file(library, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    return bytes.find(std::string_view("\0lostbits_formulas\0", 19)) != std::string::npos;
}

/// True if the library runs in its own process. In another process a formula would lose its tape and its formats, so
/// libraries with formulas stay here unless --isolate is given.
bool is_isolated(const std::filesystem::path& library, const ExternalOptions& words) {
    return words.isolate || (words.isolate_by_default && !has_formulas(library));
}

/// The names of the forms that are not in the catalogue; with `harmful`, of those that are not isolated.
std::vector<std::string> names_added(bool harmful = false) {
    std::vector<std::string> names;
    for (const auto& form : intersect::table::intersectors().subspan(intersect::table::catalogue().size()))
        if (!harmful || !intersect::external::is_safe_to_run(form)) names.emplace_back(form.info->name);
    return names;
}

/// The item itself and, for `FORM+FORM`, `FORM@WAY` and `FORM^BOX~WAY`, each of its parts.
std::vector<std::string> parts_named(const std::string& item) {
    std::vector<std::string> names{item};
    for (std::size_t begin = 0, end = 0; begin <= item.size(); begin = end + 1) {
        end = std::min(item.find_first_of("+@^~", begin), item.size());
        names.push_back(item.substr(begin, end - begin));
    }
    return names;
}

std::string_view primitives_of(Shape shape) {
    return is_primitive(shape) ? row_of(shape).plural : "fields of distances";
}

}  // namespace

std::string this_program(const std::string& words) {
    std::error_code unknown;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
    if (unknown)
        throw EnvironmentError(
            "the path of this program is unknown (/proc is missing), so it cannot start itself again in another "
            "process; mount /proc");
    return fmt::format("exec {} {}", shell_word(program.string()), words);
}

std::vector<std::string> devices_of(const std::vector<std::string>& words) {
    std::vector<std::string> kinds;
    const auto add = [&kinds](std::string_view kind) { add_once(kinds, std::string(kind)); };
    for (const std::string& word : words) {
        if (word == "all") std::ranges::for_each(intersect::device::device_kinds, add);
        else if (std::ranges::find(intersect::device::device_kinds, word) != std::end(intersect::device::device_kinds))
            add(word);
        else
            throw InputError(fmt::format("--device {} is not one of {}, all", word,
                                         fmt::join(intersect::device::device_kinds, ", ")));
    }
    if (words.empty()) kinds.emplace_back();
    return kinds;
}

void decide_where(ExternalOptions& words, bool is_gate) {
    const char* const ci = intersect::process::own_environment("CI");
    words.isolate_by_default = !words.isolate && !words.in_process && (is_gate || (ci != nullptr && *ci != '\0'));
}

std::string loaded_here(const ExternalOptions& words) {
    std::string all;
    for (const std::string& named : words.plugins) {
        const auto library = intersect::external::find_plugin(named);
        if (!is_isolated(library, words)) all += (all.empty() ? "" : ", ") + library.string();
    }
    return all;
}

void note_where(const ExternalOptions& words, bool times) {
    if (!words.isolate_by_default) return;
    const std::string here = loaded_here(words);
    if (!here.empty())
        fmt::print(stderr,
                   "lostbits: {}: has formulas, so it runs in this process; if it ends the process, the exit status is "
                   "3. --isolate runs it in its own process, in f32 and f64 only\n",
                   here);
    if (times && !words.plugins.empty())
        fmt::print(stderr,
                   "lostbits: CI is set, so each library runs in its own process, and its times include the transfer "
                   "of rays and answers; use --in-process to avoid the transfer\n");
}

ExternalForms open_each(const ExternalOptions& words, int threads) {
    if ((words.isolate || words.in_process) && words.plugins.empty())
        throw InputError(
            fmt::format("{} is for libraries; name one by --plugin", words.isolate ? "--isolate" : "--in-process"));
    if (!words.devices.empty() && words.shaders.empty())
        throw InputError("--device is for shaders; name one by --shader");
    if (words.plugins.empty() && words.pipes.empty() && words.shaders.empty() && words.functions.empty()) return {};
    intersect::external::guard_foreign_code(
        {words.seconds, words.stop, output::file::remove_partial_files, words.ends_with});
    const int processes = threads > 0 ? threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const PipeTerms terms{.seconds = words.seconds, .processes = static_cast<unsigned>(processes), .stop = words.stop};
    ExternalForms found;
    const auto add = [](auto more, auto& all) { std::ranges::move(more, std::back_inserter(all)); };
    std::string again;
    std::map<std::string, std::string> library_of;  // by name of the formula
    for (const std::string& named : words.plugins) {
        const auto library = intersect::external::find_plugin(named);
        scene::toml::note_read(library);
        const bool apart = is_isolated(library, words);
        auto forms = apart ? isolated(library, terms) : intersect::external::load_plugin(library);
        auto formulas =
            apart ? std::vector<intersect::external::Formula>() : intersect::external::load_formulas(library);
        if (const std::string prefix = intersect::external::prefix_of_plugin(named); !prefix.empty()) {
            for (auto& form : forms) intersect::external::rename(form, prefix);
            for (auto& formula : formulas) intersect::external::rename(formula, prefix);
        }
        for (const auto& formula : formulas) {
            const std::string form(formula.row.info->name);
            if (const auto [known, is_new] = library_of.try_emplace(form, library.string()); !is_new)
                throw InputError(fmt::format(
                    "{0}: {1} and {2} both have a form of this name; give one library a name: --plugin new={2} calls "
                    "its form new.{0}",
                    form, known->second, library.string()));
        }
        add(std::move(forms), found.forms);
        add(std::move(formulas), found.formulas);
        again += " --plugin " + shell_word(named);
    }
    for (const std::string& command : words.pipes) {
        add(open_pipe(command, terms), found.forms);
        again += " --pipe " + shell_word(command);
    }
    for (const std::string& shader : words.shaders) {
        for (std::size_t end = shader.size(); end != std::string::npos && end > 0; end = shader.rfind(':', end - 1))
            scene::toml::note_read(shader.substr(0, end));  // FILE:FUNCTION
        add(served_by_each(shader, words, terms), found.forms);
        again += " --shader " + shell_word(shader);
    }
    for (const std::string& function : words.functions) again += " --function " + shell_word(function);
    for (const std::string& device : words.devices) again += " --device " + shell_word(device);
    output::attribution::set_plugin_options(again);
    return found;
}

namespace {

/// `adds x + (y + z) in place of (x + y) + z`, or how far the first operation is off.
std::string difference_in_words(const measure::tape::DriverDifference& found) {
    std::vector<std::string> all;
    for (const auto& rewriting : found.rewritings)
        all.push_back(rewriting.name + (rewriting.sites.size() > 1 ? fmt::format(" ({} times)", rewriting.sites.size())
                                                                   : std::string()));
    if (found.inexact != no_node)
        all.push_back(fmt::format("is up to {} in the last place off in an operation",
                                  scene::toml::counted(static_cast<std::uint64_t>(found.ulps), "unit")));
    return fmt::format("{}", fmt::join(all, ", and "));
}

/// Compares a function of a shader with what drivers answer, where the same function is also given to `--shader`.
void note_drivers(const intersect::function::UserFunction& function) {
    const auto& program = function.row;
    const std::string from =
        fmt::format("{}:{} on ", std::filesystem::path(function.path).filename().string(), function.line);
    // Without words in the file --shader takes one t for the near root, and --function for the first one.
    const auto tells_both = [](intersect::Roots roots) { return roots == intersect::Roots::both; };
    for (const auto& row : intersect::table::intersectors()) {
        for (const ForeignForm* const form : intersect::external::behind(row)) {
            if (!form->contract.source.starts_with(from) || form->contract.bits != 32 || function.bits != 32 ||
                row.shape != program.shape || tells_both(form->contract.roots) != tells_both(program.info->roots))
                continue;
            const auto found = measure::tape::driver_difference(row, program);
            const std::string who = fmt::format("lostbits: {} ({})", row.info->name, form->contract.source);
            if (found.differ == 0) {
                fmt::print(stderr, "{}: the driver gives the bits of the followed function on {} random rays\n", who,
                           found.rays);
                continue;
            }
            const std::string differs =
                fmt::format("{}: the driver gives other bits than the followed function on {} of {} random rays", who,
                            found.differ, found.rays);
            if (!found.is_explained()) {
                fmt::print(stderr,
                           "{}; no tried change explains all of these rays (another order of sums, fused "
                           "products, reciprocals, common factors, subnormal numbers as 0, an inexact quotient or "
                           "root), so lostbits cannot name the operation\n",
                           differs);
                continue;
            }
            const std::string line =
                intersect::function::quoted_line(*program.info, *find_format("f32"), found.first());
            fmt::print(stderr, "{}: it {}\n{}", differs, difference_in_words(found),
                       line.empty() ? "" : "first here: " + line);
        }
    }
}

}  // namespace

void open_external(const ExternalOptions& words, int threads) {
    ExternalForms found = open_each(words, threads);
    // A library with formulas has the C interface too, for --isolate and `plugin check`; the formulas are used here.
    std::erase_if(found.forms, [&found](const ForeignForm& form) {
        return std::ranges::any_of(found.formulas,
                                   [&form](const auto& f) { return f.row.info->name == form.contract.name; });
    });
    intersect::external::register_formulas(found.formulas);
    intersect::external::register_forms(std::move(found.forms));
    for (const std::string& named : words.functions) {
        auto function = load_shown_function(named, words);
        if (!words.quiet) note_drivers(*function);
        intersect::function::register_forms(std::move(function));
    }
}

std::unique_ptr<intersect::function::UserFunction> load_shown_function(const std::string& named,
                                                                       const ExternalOptions& words) {
    auto function = intersect::function::load_function(named, {.seconds = words.seconds, .stop = words.stop});
    scene::toml::note_read(function->path);
    if (!words.quiet) fmt::print(stderr, "lostbits: {}\n", function->shown);
    return function;
}

void note_states() {
    std::map<std::string, std::string> states;  // by library
    for (const auto& row : intersect::table::intersectors()) {
        for (const ForeignForm* const form : intersect::external::behind(row))
            if (!form->contract.state.empty()) states.try_emplace(form->from, form->contract.state);
    }
    for (const auto& [who, words] : states)
        fmt::print(stderr,
                   "lostbits: {}: changes how the processor computes ({}) when it is loaded, as linking with -Ofast "
                   "does; only this library is measured in that state, as its users run it\n",
                   who, words);
}

std::vector<std::string> form_words_or(const std::vector<std::string>& given, std::vector<std::string> defaults) {
    if (!given.empty()) return given;
    std::ranges::move(names_added(), std::back_inserter(defaults));
    return defaults;
}

void note_unmeasured(const std::vector<std::string>& words, const std::vector<measure::evaluate::TestedForm>& rows,
                     bool quiet) {
    if (quiet) return;
    const std::vector<std::string> added = names_added();
    const auto is_asked = [&](const std::string& name) {
        if (std::ranges::find(words, name) != words.end()) return true;
        return std::ranges::find(added, name) != added.end() && (words.empty() || matches_any(words, name));
    };
    std::map<std::string, std::vector<std::string_view>> left_out;  // by the shapes and formats that they take
    for (const auto& form : intersect::table::intersectors()) {
        if (!is_asked(std::string(form.info->name))) continue;
        const auto asks_it = [&form](const auto& row) {
            return row.form == &form || std::ranges::find(row.form->parts, &form) != row.form->parts.end();
        };
        if (std::ranges::any_of(rows, asks_it)) continue;
        const std::string formats = formats_of(form);
        left_out[fmt::format("for {} in {}", primitives_of(form.shape), formats == "all" ? "every format" : formats)]
            .push_back(form.info->name);
    }
    for (const auto& [what, names] : left_out)
        fmt::print(stderr, "lostbits: left out: {} {} {}; nothing in the selection has that shape and format\n",
                   fmt::join(names, ", "), names.size() == 1 ? "is" : "are", what);
}

void note_unasked(const shell::Command& command) {
    const shell::Option forms = command.option("--form");
    const shell::Option beside = command.option("--beside");  // a command without it uses isolated forms too
    const std::vector<std::string> names = names_added(static_cast<bool>(beside));
    if (names.empty() || !forms || forms.words().empty()) return;
    std::vector<std::string> words;
    for (const shell::Option& option : {forms, beside, command.option("--against")}) {
        for (const std::string& word : option ? option.words() : std::vector<std::string>())
            for (const std::string& item : shell::items_in(word, option.name()))
                std::ranges::move(parts_named(item), std::back_inserter(words));
    }
    if (std::ranges::none_of(names, [&words](const auto& name) { return matches_any(words, name); }))
        fmt::print(stderr, "lostbits: {} {} loaded but not selected; add -i {}\n", fmt::join(names, ", "),
                   names.size() == 1 ? "is" : "are", names.front());
}

DeviceReport ask_device(std::string_view kind, const ExternalOptions& words) {
    DeviceReport told{.kind = std::string(kind), .facts = {}, .lacks = {}};
    try {
        intersect::process::Child child(
            this_program("shader probe " + told.kind),
            {.who = told.kind, .timeout_advice = "", .seconds = words.seconds, .stop = words.stop});
        for (std::string line = child.read_line(); !line.empty(); line = child.read_line()) {
            const std::size_t equals = line.find('=');
            if (equals == std::string::npos) child.fail("wrote " + line + " instead of a line NAME=FACT");
            if (line.starts_with("missing=")) told.lacks = line.substr(equals + 1);
            else told.facts.emplace_back(line.substr(0, equals), line.substr(equals + 1));
        }
    } catch (const EnvironmentError& dead) {  // the driver crashed or hung
        told.lacks = dead.what();
    }
    return told;
}

}  // namespace lostbits::analysis::selection
