#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iterator>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include "analysis/selection/external.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/subject_kinds.hpp"
#include "analysis/shard/division.hpp"
#include "analysis/shell/command_line.hpp"
#include "analysis/shell/option_table.hpp"
#include "analysis/shell/process.hpp"
#include "analysis/shell/renamed.hpp"
#include "analysis/shell/table_on_stdout.hpp"
#include "commands.hpp"
#include "intersect/external/guard.hpp"
#include "intersect/process/floating_point.hpp"
#include "intersect/process/process_state.hpp"
#include "intersect/simd/packed.hpp"
#include "number/error.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"
#include "scene/toml/file_names.hpp"
#include "scene/toml/files_of_run.hpp"

namespace lostbits::analysis {
namespace {

constexpr const char* description =
    "A precision laboratory for ray intersectors: where significand bits are lost, which operation loses them,\n"
    "whether the formula or the problem is to blame, and what the safer form costs.";

void add_common(const shell::Command& program, CommonOptions& common) {
    program.add("--data", common.data,
                "Folder with scenes/, sweeps/, claims/ (default: $LOSTBITS_DATA, then ./data, then the program's "
                "own)");
    const auto set_progress = [&common](int mode) {
        common.progress = static_cast<output::file::Progress::Mode>(mode);
    };
    program.add_named("--progress", {"auto", "bar", "none"}, set_progress,
                      "Progress on stderr (default: auto, which shows it only on a terminal)");

    // Outputs and messages.
    program.add("--force", common.force,
                "Write into a folder of results, such as out/map/SCENE, even if it has pictures or tables that "
                "lostbits did not make; they are kept, and none is overwritten");
    program.add_list("--figure", common.figures, "Kinds of pictures (default: png); svg and pdf are vector graphics",
                     shell::one_of({"png", "svg", "pdf"}));
    program.add("-q,--quiet", common.quiet, "Print errors only");
    program.add("-v,--verbose", common.verbose, "Print more detail");

    // How the processor is used.
    program.add("-j,--threads", common.threads,
                "Number of threads (default: one per core); results do not depend on it",
                shell::whole_number_between(1, 1024));
    program.add("--isa", common.isa,
                "SIMD register width in bits (default: the widest of this processor); results do not depend on it",
                shell::one_of({intersect::simd::isa_names.begin(), intersect::simd::isa_names.end()}));
}

void add_external_options(const shell::Command& program, selection::ExternalOptions& external) {
    program.add("--plugin", external.plugins,
                "Also measure the forms of a library (docs/your-own-intersector.md); may be repeated");
    program.add(
        "--pipe", external.pipes,
        "Also measure the forms of a command that reads rays and writes answers (docs/pipe.md); may be repeated");
    program.add("--shader", external.shaders,
                "Also measure a GLSL or HLSL function, run by this machine's driver (docs/shader.md); may be repeated");
    program.add(
        "--function", external.functions,
        "Also measure a C, C++, Rust, GLSL or HLSL function as it stands (docs/your-function.md); may be repeated");
    program.add_list("--device", external.devices,
                     "Driver for --shader: opengl, vulkan, or all (default: the first that works)");

    // The process in which they run, and for how long.
    const auto isolate =
        program.add("--isolate", external.isolate,
                    "Run each library in a process of its own, so that neither a crash nor _exit reaches the program "
                    "(docs/plugin-check.md); the default in `check`, and in every command if CI is set, but not for "
                    "libraries of formulas (docs/your-own-form.md)");
    program
        .add("--in-process", external.in_process,
             "Run libraries in the program itself, which is faster (the default elsewhere). In both ways, a crash ends "
             "the run with exit status 3")
        .excludes(isolate);
    program.add("--time-limit", external.seconds,
                "Seconds that a library, command, shader or compiler may take for one task (default: 30)",
                shell::number_between(0.1, 1e6));
}

constexpr const char* help_footer =
    "Exit status:\n"
    "  0    done, and every selected claim holds\n"
    "  1    done, and the answer is no: a claim fails, a difference is found, a contract is broken\n"
    "  2    bad input: the command line, or a file\n"
    "  3    the machine: a file that cannot be written, no memory, a processor that lacks what --isa names;\n"
    "       or a library, a pipe or a shader that crashes, ends the program or does not answer\n"
    "  4    nothing was selected\n"
    "  5    done, but the truth of some rays could not be proved\n"
    "  70   lostbits has a fault; please report the command and the message\n"
    "  130  interrupted; finished files stay\n"
    "\nEnvironment:\n"
    "  CI                       set to anything: libraries run in processes of their own, see --isolate\n"
    "  LOSTBITS_DATA            the folder with scenes/, sweeps/ and claims/\n"
    "  LOSTBITS_DEVICE_MODULES  the folder in which the driver modules of --shader are looked for first\n"
    "  LOSTBITS_PLUGIN_PATH     folders to look for a --plugin in, with colons between them\n"
    "  NO_COLOR                 set to anything: no colours\n"
    "  TMPDIR                   the folder for temporary files, such as those of `-o -`\n"
    "\nSee also:\n"
    "  `lostbits COMMAND --help`, `lostbits completion --help`, `lostbits manual | man -l -`\n";

/// Adds the commands that print completion scripts and the manual page.
void add_shell(const shell::Command& program) {
    const auto add_printer = [](const shell::Command& command, const std::function<std::string()>& text) {
        command.set_action([text] {
            fmt::print("{}", text());
            return ExitStatus::done;
        });
    };
    auto completion = program.add_command(
        "completion", "Write a shell script that completes commands and options: `source <(lostbits completion bash)`");
    add_printer(completion.add_command("bash", "For bash"), [&program] { return shell::bash_completion(program); });
    add_printer(completion.add_command("zsh", "For zsh: the file _lostbits in a folder of $fpath"),
                [&program] { return shell::zsh_completion(program); });
    add_printer(completion.add_command("fish", "For fish: `lostbits completion fish | source`"),
                [&program] { return shell::fish_completion(program); });
    add_printer(program.add_command("manual", "Write the manual page: `lostbits manual | man -l -`"),
                [&program] { return shell::manual_page(program, LOSTBITS_VERSION, help_footer); });
}

/// Returns the common options as arguments, for a run that joins shards. They replace those of the shards' own command
/// lines.
std::vector<std::string> to_arguments(const CommonOptions& common) {
    std::vector<std::string> arguments{"--progress", "none"};
    if (common.quiet) arguments.emplace_back("-q");
    if (common.verbose) arguments.emplace_back("-v");
    if (common.force) arguments.emplace_back("--force");
    if (common.threads > 0) arguments.insert(arguments.end(), {"-j", std::to_string(common.threads)});
    if (!common.isa.empty()) arguments.insert(arguments.end(), {"--isa", common.isa});
    return arguments;
}

ExitStatus run_arguments(const std::vector<std::string>& arguments, std::shared_ptr<shard::Shards> shards);

void add_merge(const shell::Command& program, const CommonOptions& common) {
    shard::add_merge(program, program_and_version,
                     [&common](std::vector<std::string> command_arguments, std::shared_ptr<shard::Shards> shards) {
                         std::ranges::move(to_arguments(common), std::back_inserter(command_arguments));
                         return run_arguments(command_arguments, std::move(shards));
                     });
}

/// The commands in the order in which the help lists them: first those that a new user needs. Others follow by name.
constexpr std::string_view command_order[] = {"map",    "explain", "sweep",       "judge",   "choose", "trade",
                                              "mend",   "offsets", "consistency", "render",  "diff",   "check",
                                              "report", "merge",   "plugin",      "devices", "list"};

void add_commands(const shell::Command& program, const CommonOptions& common) {
    std::vector<NamedCommand> commands{{"check", add_check},   {"choose", add_choose},   {"devices", add_devices},
                                       {"diff", add_diff},     {"explain", add_explain}, {"judge", add_judge},
                                       {"list", add_list},     {"map", add_map},         {"mend", add_mend},
                                       {"merge", add_merge},   {"plugin", add_plugin},   {"report", add_report},
                                       {"shader", add_shader}, {"sweep", add_sweep},     {"trade", add_trade}};
    std::ranges::move(study_commands(), std::back_inserter(commands));
    const auto position = [](const NamedCommand& command) {
        return std::pair(std::ranges::find(command_order, command.name) - std::begin(command_order),
                         std::string_view(command.name));
    };
    std::ranges::sort(commands, {}, position);
    for (const NamedCommand& command : commands) command.add(program, common);
}

using IsCommand = std::function<bool(const char*)>;

/// Loads the libraries, pipes, shaders and functions of the options. Returns in the process that does the work, see
/// `supervise`.
void load_external(const shell::Command& program, CommonOptions& common, const IsCommand& is_command) {
    if (!common.quiet) selection::note_isolation(common.external, is_command("trade") || is_command("choose"));
    if (const std::string libraries = selection::libraries_in_process(common.external); !libraries.empty())
        shell::supervise(libraries, common.external.seconds);
    common.external.quiet = common.quiet;
    selection::open_external(common.external, common.threads);
    shell::open_standard_streams();  // a library may have closed one
    if (common.quiet) return;
    selection::note_processor_states();
    selection::note_unused_external_forms(program.given_commands().back());
}

/// Runs the command that was given, and writes its table to standard output if `-o -` asks for it.
ExitStatus run_given_command(const shell::CommandLine& program, CommonOptions& common) {
    const IsCommand is_command = [name = program.given_commands().at(1).name()](const char* command) {
        return name == command;
    };
    // These commands load external code themselves, or in other processes.
    const bool loads_driver = is_command("shader") || is_command("devices");
    if (!loads_driver) selection::decide_isolation(common.external, is_command("check"));
    if (!loads_driver && !is_command("plugin")) load_external(program, common, is_command);

    shell::TableOnStdout table(program);
    const ExitStatus status = program.run();
    table.write();
    // `plugin` prints these notes itself, or its caller does.
    if (!common.quiet && !is_command("plugin")) {
        for (const std::string& note : intersect::external::noted_changes())
            fmt::print(stderr, "lostbits: {}\n", output::file::terminal_text(note));
    }
    return status;
}

/// Runs the command that the arguments name. `shards`: its finished shards, which it joins; null: it does the work
/// itself.
ExitStatus run_arguments(const std::vector<std::string>& arguments, std::shared_ptr<shard::Shards> shards) {
    shell::CommandLine program("lostbits", program_and_version, description);
    CommonOptions common;
    common.shards_to_join = std::move(shards);
    common.external.on_fatal_fault = shell::report_status;
    common.stop = common.external.stop = shell::stop_by_signal();
    add_common(program, common);
    add_external_options(program, common.external);
    add_commands(program, common);
    add_shell(program);
    add_examples(program);

    const shell::UpdatedArguments updated = shell::replace_former_names(program, arguments);
    try {
        const auto parsed = program.parse(updated.arguments);
        if (parsed == shell::CommandLine::ParseOutcome::help) fmt::print("{}", shell::help_page(program, help_footer));
        if (parsed != shell::CommandLine::ParseOutcome::command) return ExitStatus::done;
    } catch (const shell::CommandLineError& error) {
        fmt::print(stderr, "lostbits: {}\nlostbits: see `{} --help`\n",
                   output::file::terminal_text(shell::describe_error(program, error)), program.command_path());
        return ExitStatus::bad_input;
    }

    if (!common.quiet)
        for (const std::string& advice : updated.advice)
            fmt::print(stderr, "lostbits: {}\n", output::file::terminal_text(advice));
    common.typed_command = selection::typed_command(program);
    selection::find_in_data(program.given_commands().back(), common.data);
    selection::require_argument_kinds(program, selection::data_folder(common.data));
    if (const auto isa = intersect::simd::find_isa(common.isa)) intersect::simd::set_isa(*isa);
    return run_given_command(program, common);
}

}  // namespace
}  // namespace lostbits::analysis

namespace {

/// Called when an exception is not caught, or when a library gives up (a thread pool without memory for its threads).
/// Removes partial files and says why the program ends.
[[noreturn]] void on_terminate() {
    lostbits::output::file::remove_partial_files();
    // Without foreign code in the process, an uncaught exception is a bug of lostbits.
    const char* const foreign_code = lostbits::intersect::external::running_foreign_code();
    const bool is_foreign = lostbits::intersect::process::has_foreign_code();

    // A lack of memory or of threads is a fault of the environment.
    auto status = lostbits::ExitStatus::environment;
    try {
        if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
    } catch (const std::system_error&) {  // no more threads
    } catch (...) {
        if (!is_foreign) status = lostbits::ExitStatus::internal;
    }

    if (foreign_code != nullptr)
        std::fprintf(stderr, "lostbits: %s: threw an exception where nothing can catch it; catch it there\n",
                     foreign_code);
    else if (!is_foreign)
        std::fputs(
            "lostbits: a library stopped the program, perhaps for lack of memory or threads; try fewer forms, a "
            "smaller --size, a mesh of fewer triangles, or -j 1\n",
            stderr);

    // A supervisor prints the message about an exception of foreign code.
    if (foreign_code != nullptr) lostbits::analysis::shell::report_status(static_cast<int>(status));
    else if (!lostbits::analysis::shell::report_uncaught_exception(static_cast<int>(status)) && is_foreign)
        std::fputs("lostbits: an uncaught exception ended the program\n", stderr);
    std::_Exit(static_cast<int>(status));
}

/// Runs the whole program. Returns its exit status.
int run_program(int argc, char** argv) {
    using namespace lostbits;
    // stdio, not fmt: a closed stderr must not throw while an error is reported.
    const std::vector<std::string> arguments(argv, argv + argc);
    const auto fail = [&arguments](ExitStatus status, const char* message) {
        const std::string text = analysis::shell::escape_line_breaks(message, arguments);
        std::fprintf(stderr, "lostbits: %s\n", output::file::terminal_text(text).c_str());
        return static_cast<int>(status);
    };
    try {
        const scene::toml::FilesOfRun files;
        const ExitStatus status = analysis::run_arguments(arguments, nullptr);
        // A failed write to stdout (to a full disk, by redirection) loses results, as a failed write to a file does.
        intersect::process::restore_limits();
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
            return fail(ExitStatus::environment, "standard output: cannot write");
        return static_cast<int>(status);
    } catch (const Error& error) {
        return fail(error.status(), error.what());
    } catch (const std::bad_alloc&) {
        return fail(ExitStatus::environment,
                    "out of memory; try a smaller --size, fewer forms, or a mesh of fewer triangles");
    } catch (const std::filesystem::filesystem_error& error) {
        return fail(ExitStatus::bad_input, scene::toml::error_phrase(error).c_str());
    } catch (const std::system_error& error) {  // a closed stdout, no more threads
        return fail(ExitStatus::environment, std::ferror(stdout) != 0 ? "standard output: cannot write" : error.what());
    } catch (const std::exception& error) {
        return fail(ExitStatus::internal, error.what());
    } catch (...) {
        return fail(ExitStatus::internal,
                    "an exception that is not a std::exception was thrown, perhaps by a library under test");
    }
}

}  // namespace

int main(int argc, char** argv) {
    using namespace lostbits;
    // A library of LD_PRELOAD may have changed the floating-point state. Threads inherit it from the thread that starts
    // them, so set it here.
    intersect::process::FloatingPointState::standard().apply();
    analysis::shell::open_standard_streams();
    analysis::shell::install_signal_handlers();
    output::file::raise_open_file_limit();
    std::set_terminate(on_terminate);
    const int status = run_program(argc, argv);
    analysis::shell::report_status(status);
    return status;
}
