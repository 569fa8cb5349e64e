#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/selection/external.hpp"
#include "analysis/shell/process.hpp"
#include "commands.hpp"
#include "intersect/external/formulas.hpp"
#include "intersect/external/pipe.hpp"
#include "intersect/external/plugin.hpp"
#include "intersect/process/process_state.hpp"
#include "measure/contract/probe.hpp"
#include "shapes/number_names.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::analysis {

namespace {

using intersect::external::Contract;
using intersect::external::ForeignForm;
using measure::contract::Observation;

/// Answers requests on standard input with the forms of a library. If it cannot load the library, it sends the reason
/// in place of the header.
ExitStatus serve(const std::string& library) {
    const int output = redirect_standard_output("plugin serve");
    intersect::process::save_process_state();
    std::vector<ForeignForm> forms;
    try {
        forms = intersect::external::load_plugin(intersect::external::find_plugin(library));
    } catch (const Error& error) {  // the process at the other end reports it
        const std::string message = intersect::external::error_lines_of(error);
        return write(output, message.data(), message.size()) < 0 ? ExitStatus::environment : error.status();
    }
    if (intersect::external::serve_pipe(forms, STDIN_FILENO, output)) return ExitStatus::done;
    throw InputError(
        "plugin serve: standard input is not a request of lostbits-pipe/1; only `lostbits … --plugin LIBRARY "
        "--isolate` runs this command");
}

const char* verdict_text(Observation::Verdict verdict) {
    switch (verdict) {
        case Observation::Verdict::kept: return "kept";
        case Observation::Verdict::broken: return "BROKEN";
        case Observation::Verdict::warned: return "warn";
        case Observation::Verdict::noted: break;
    }
    return "note";
}

/// Tests the contract of a form and prints the findings. Returns true if the form keeps it.
bool print_trial(const ForeignForm& form, const std::optional<ForeignForm>& first, bool quiet) {
    std::vector<Observation> findings = measure::contract::try_contract(form, first ? &*first : nullptr);
    findings.push_back(measure::contract::observe_state(form));
    intersect::process::restore_limits();  // the form may have lowered the limits, which the following output may need
    const auto count = [&](Observation::Verdict v) { return std::ranges::count(findings, v, &Observation::verdict); };
    const auto broken = count(Observation::Verdict::broken), warned = count(Observation::Verdict::warned);
    const Contract& contract = form.contract;
    fmt::print("{} in binary{}, {}: {}{}\n", contract.name, contract.bits, with_article(contract.shape),
               broken == 0 ? "keeps its contract"
                           : "fails " + text::count_with_noun(static_cast<std::size_t>(broken), "probe"),
               warned == 0 ? "" : "; " + text::count_with_noun(static_cast<std::size_t>(warned), "warning"));
    if (!contract.title.empty() && !quiet) fmt::print("  {}\n", contract.title);
    if (!contract.source.empty() && !quiet) fmt::print("  from {}\n", contract.source);
    for (const Observation& observation : findings) {
        if (!quiet || observation.verdict == Observation::Verdict::broken ||
            observation.verdict == Observation::Verdict::warned)
            fmt::print("  {:<6} {:<12} {}\n", verdict_text(observation.verdict), observation.subject, observation.text);
    }
    std::fflush(stdout);  // before the next form, which may crash
    return broken == 0;
}

/// Checks every form of a library or of a command. Returns answer_is_no if a form breaks its contract.
ExitStatus try_forms(const std::string& library, const CommonOptions& common) {
    selection::ExternalOptions options = common.external;
    if (!library.empty()) options.plugins.push_back(library);
    if (const std::string libraries = selection::libraries_in_process(options); !libraries.empty())
        shell::supervise(libraries, options.seconds);
    const auto [forms, formulas] = selection::load_external_forms(options, common.threads);
    if (forms.empty() && options.functions.empty())
        throw InputError(
            "plugin check: nothing to check; name a library, a command by --pipe, or a function by --function");
    bool all_kept = true;
    for (const ForeignForm& form : forms)
        all_kept =
            print_trial(form, intersect::external::find_first_root_form(formulas, form), common.quiet) && all_kept;
    for (const std::string& function_name : options.functions) {
        const auto function = selection::load_shown_function(function_name, options);
        const auto& answers = function->answers->batch32 ? function->answers->batch32 : function->answers->batch64;
        all_kept = print_trial(answers->form(), {}, common.quiet) && all_kept;
    }
    return all_kept ? ExitStatus::done : ExitStatus::answer_is_no;
}

}  // namespace

int redirect_standard_output(const std::string& command) {
    const int output = dup(STDOUT_FILENO);
    if (output < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
        throw EnvironmentError(command + ": standard output is closed");
    return output;
}

void add_plugin(const shell::Command& program, const CommonOptions& common) {
    auto command = program.add_command("plugin", "Test whether your function keeps its contract");
    const auto library = std::make_shared<std::string>();
    auto check_command =
        command.add_command("check",
                            "Test whether the forms of a library, of --pipe or of --function keep their "
                            "contracts");
    check_command.add("LIBRARY", *library, "The library (not needed with --pipe or --function)");
    check_command.set_action([library, &common] { return try_forms(*library, common); });
    auto serve_command = command.add_command(
        "serve", "Answer rays on standard input with the forms of a library (what --isolate starts)");
    serve_command.hide_from_help();
    serve_command.add("LIBRARY", *library, "The library").required();
    serve_command.set_action([library] { return serve(*library); });
}

}  // namespace lostbits::analysis
