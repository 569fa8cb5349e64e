#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <map>
#include <new>
#include <system_error>

#include "analysis/choice/doors.hpp"
#include "analysis/choice/options.hpp"
#include "analysis/shard/merge.hpp"
#include "analysis/shell/completion.hpp"
#include "analysis/shell/process.hpp"
#include "analysis/shell/supervisor.hpp"
#include "analysis/shell/table_on_stdout.hpp"
#include "analysis/shell/usage.hpp"
#include "commands.hpp"
#include "intersect/doors/guard.hpp"
#include "intersect/process/floating_point.hpp"
#include "intersect/simd/packed.hpp"
#include "number/error.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"
#include "scene/toml/files_of_run.hpp"

namespace lostbits::analysis {
namespace {

constexpr const char* description =
    "A precision laboratory for ray intersectors: where significand bits are lost, which operation loses them,\n"
    "whether the formula or the problem is to blame, and what the safer form costs.";

void add_common(CLI::App& program, Common& common) {
    using Mode = output::file::Progress::Mode;
    static const std::map<std::string, Mode> modes{{"auto", Mode::automatic}, {"bar", Mode::bar}, {"none", Mode::none}};
    program.add_option(
        "--data", common.data,
        "Folder with scenes/, sweeps/, claims/ (default: $LOSTBITS_DATA, ./data, the one of the program)");
    program.add_option("--progress", common.progress, "Progress on stderr: auto (on a terminal), bar, none")
        ->transform(CLI::CheckedTransformer(modes))
        ->default_str("auto");
    program.add_flag("--force", common.force,
                     "Write into a folder of results although it holds some that no manifest.json names; they stay");
    program.add_flag("-q,--quiet", common.quiet, "Print errors only");
    program.add_flag("-v,--verbose", common.verbose, "Print more detail");
    program.add_option("-j,--threads", common.threads, "Threads (default: one per core); results do not depend on it")
        ->check(CLI::Range(1, 1024));
    program
        .add_option("--isa", common.isa,
                    "Width of the registers: scalar, 128, 256, 512 (default: the widest of this processor); results do "
                    "not depend on it")
        ->check(CLI::IsMember(
            std::vector<std::string>(intersect::simd::isa_names.begin(), intersect::simd::isa_names.end())));
}

void add_doors(CLI::App& program, choice::DoorWords& doors) {
    program.add_option(
        "--plugin", doors.plugins,
        "A library of intersectors of your own (lostbits_plugin.h); its forms stand beside the others. May "
        "be repeated");
    program.add_option("--pipe", doors.pipes,
                       "A command that reads rays on its standard input and answers on its standard output, in any "
                       "language; its forms stand beside the others. May be repeated");
    program.add_option(
        "--shader", doors.shaders,
        "A file of GLSL or HLSL with a function that intersects, run by this machine's driver; its form "
        "shader.NAME stands beside the others. FILE.glsl:FUNCTION names one of several. May be repeated");
    choice::add_list(program, "--device", doors.devices,
                     "What runs --shader: opengl, vulkan, or all that there are (default: the first that there is)");
    auto* const isolate =
        program.add_flag("--isolate", doors.isolate,
                         "Run libraries in processes of their own, so that none can end the program (default: for "
                         "`check`, and wherever CI is set in the environment; not those of formulas)");
    program
        .add_flag("--in-process", doors.in_process,
                  "Run libraries in the program itself: faster, and a crash or exit of theirs ends it with 3")
        ->excludes(isolate);
    program
        .add_option("--time-limit", doors.seconds,
                    "Seconds that --plugin, --pipe and --shader may take for a batch (30)")
        ->check(choice::number_from(0.1, 1e6));
}

constexpr const char* footer =
    "Exit status:\n"
    "  0    done, and every selected claim holds\n"
    "  1    done, and the answer is no: a claim fails, a difference is found, a promise is broken\n"
    "  2    bad input: what was typed, or a file\n"
    "  3    the machine: a file that cannot be written, no memory, a processor that lacks what --isa names;\n"
    "       or a library, a pipe or a shader that crashes, ends the program or does not answer\n"
    "  4    nothing was selected\n"
    "  70   something could not be proved\n"
    "  130  interrupted; finished files stay\n"
    "Environment:\n"
    "  CI                    set to anything: libraries run in processes of their own, see --isolate\n"
    "  LOSTBITS_DATA         the folder with scenes/, sweeps/ and claims/\n"
    "  LOSTBITS_DEVICE_MODULES  a folder to look for the modules of --shader in first\n"
    "  LOSTBITS_PLUGIN_PATH  folders to look for a --plugin in, with colons between them\n"
    "  NO_COLOR              set to anything: no colours\n"
    "  TMPDIR                where `-o -` keeps what it does not print\n"
    "See also:\n"
    "  `lostbits COMMAND --help`, `lostbits completion bash`, `lostbits manual | man -l -`\n";

/// Words for shells and for man(1), made of the options of all commands.
void add_shell(CLI::App& program, Command& chosen) {
    const auto add = [&](CLI::App& command, std::function<std::string()> text) {
        command.callback([text = std::move(text), &chosen] {
            chosen = [text] {
                fmt::print("{}", text());
                return Exit::done;
            };
        });
    };
    auto* const completion = program.add_subcommand(
        "completion", "A script that completes the words of this program: `source <(lostbits completion bash)`");
    completion->require_subcommand(1);
    add(*completion->add_subcommand("bash", "For bash"), [&program] { return shell::bash_completion(program); });
    add(*completion->add_subcommand("zsh", "For zsh: the file _lostbits in a folder of $fpath"),
        [&program] { return shell::zsh_completion(program); });
    add(*completion->add_subcommand("fish", "For fish: `lostbits completion fish | source`"),
        [&program] { return shell::fish_completion(program); });
    add(*program.add_subcommand("manual", "The manual page: `lostbits manual | man -l -`"),
        [&program] { return shell::manual_page(program, LOSTBITS_VERSION); });
}

/// What joins shards shows and does as the command line says, not as each of them did.
std::vector<std::string> words_of(const Common& common) {
    std::vector<std::string> words{"--progress", "none"};
    if (common.quiet) words.emplace_back("-q");
    if (common.verbose) words.emplace_back("-v");
    if (common.force) words.emplace_back("--force");
    if (common.threads > 0) words.insert(words.end(), {"-j", std::to_string(common.threads)});
    if (!common.isa.empty()) words.insert(words.end(), {"--isa", common.isa});
    return words;
}

/// `joined`: shards of this command that are to be joined; null where it is to be done.
Exit run_words(const std::vector<std::string>& words, std::shared_ptr<shard::Shards> joined) {
    CLI::App program{description, "lostbits"};
    program.require_subcommand(1);
    program.fallthrough();
    program.footer(footer);
    program.set_version_flag("--version", "lostbits " LOSTBITS_VERSION);
    Common common;
    common.joined = std::move(joined);
    common.doors.ends_with = shell::tell_status;
    common.stop = common.doors.stop = shell::stop_by_signal();
    Command chosen;
    add_common(program, common);
    add_doors(program, common.doors);
    add_check(program, common, chosen);
    add_choose(program, common, chosen);
    add_consistency(program, common, chosen);
    add_devices(program, common, chosen);
    add_diff(program, common, chosen);
    add_explain(program, common, chosen);
    add_judge(program, common, chosen);
    add_list(program, common, chosen);
    add_map(program, common, chosen);
    shard::add_merge(program, chosen, program_and_version,
                     [&common](std::vector<std::string> again, std::shared_ptr<shard::Shards> shards) {
                         std::ranges::move(words_of(common), std::back_inserter(again));
                         return run_words(again, std::move(shards));
                     });
    add_offsets(program, common, chosen);
    add_plugin(program, common, chosen);
    add_render(program, common, chosen);
    add_report(program, common, chosen);
    add_shader(program, chosen);
    add_sweep(program, common, chosen);
    add_trade(program, common, chosen);
    add_shell(program, chosen);
    choice::one_value_each(program);
    try {
        std::vector<const char*> argv;
        for (const std::string& word : words) argv.push_back(word.c_str());
        program.parse(static_cast<int>(argv.size()), argv.data());
    } catch (const CLI::Success& success) {  // --help, --version
        return static_cast<Exit>(program.exit(success));
    } catch (const CLI::ParseError& error) {
        const CLI::App& command = shell::command_named(program);
        fmt::print(stderr, "lostbits: {}\nlostbits: see `{} --help`\n",
                   output::file::terminal_text(shell::what_is_wrong(program, error)),
                   &command == &program ? "lostbits" : "lostbits " + command.get_name());
        return Exit::bad_input;
    }
    common.typed = choice::typed(program);
    if (const auto isa = intersect::simd::isa_named(common.isa)) intersect::simd::set_isa(*isa);
    const auto named = [&program](const char* name) { return program.got_subcommand(name); };
    if (!named("shader") && !named("devices")) choice::decide_where(common.doors, named("check"));
    if (!named("plugin") && !named("shader") && !named("devices")) {
        if (!common.quiet) choice::note_where(common.doors, named("trade") || named("choose"));
        if (const std::string here = choice::loaded_here(common.doors); !here.empty())
            shell::supervise(here, common.doors.seconds);
        choice::open_doors(common.doors, common.threads);
        shell::open_standard_streams();  // a library may have closed one
        if (!common.quiet) {
            choice::note_states();
            choice::note_unasked(shell::command_named(program));
        }
    }
    shell::TableOnStdout table(program);
    const Exit code = chosen();
    table.write();
    // Of a process behind a pipe, and of what is only tried, whoever asks says it.
    if (!common.quiet && !program.got_subcommand("plugin")) {
        for (const std::string& note : intersect::doors::changes_noted())
            fmt::print(stderr, "lostbits: {}\n", output::file::terminal_text(note));
    }
    return code;
}

}  // namespace
}  // namespace lostbits::analysis

namespace {

/// A library that gives up (a thread pool without memory for its threads) ends here: no partial file stays.
[[noreturn]] void on_terminate() {
    lostbits::output::file::remove_partial_files();
    if (const char* const who = lostbits::intersect::doors::foreign_code_here())
        std::fprintf(stderr, "lostbits: %s: threw an exception where nobody can catch it; catch it there\n", who);
    else
        std::fputs(
            "lostbits: a library stopped the program, perhaps for lack of memory or threads; try fewer forms, a "
            "smaller --size, or -j 1\n",
            stderr);
    auto code = lostbits::Exit::environment;
    try {
        if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
    } catch (const std::system_error&) {  // no more threads
    } catch (...) {
        code = lostbits::Exit::internal;
    }
    lostbits::analysis::shell::tell_status(static_cast<int>(code));
    std::_Exit(static_cast<int>(code));
}

/// The whole program, and its status.
int run_program(int argc, char** argv) {
    using namespace lostbits;
    // stdio, not fmt: what cannot be written because stderr is closed must not throw while an error is reported.
    const std::vector<std::string> words(argv, argv + argc);
    const auto fail = [&words](Exit code, const char* message) {
        const std::string text = analysis::shell::with_words_on_one_line(message, words);
        std::fprintf(stderr, "lostbits: %s\n", output::file::terminal_text(text).c_str());
        return static_cast<int>(code);
    };
    try {
        const scene::toml::FilesOfRun files;
        const Exit code = analysis::run_words(words, nullptr);
        // What stdout did not take (a full disk behind a redirection) is as lost as a file that was not written.
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
            return fail(Exit::environment, "standard output: cannot write");
        return static_cast<int>(code);
    } catch (const Error& error) {
        return fail(error.code(), error.what());
    } catch (const std::bad_alloc&) {
        return fail(Exit::environment, "out of memory; try a smaller --size or fewer forms");
    } catch (const std::system_error& error) {  // a closed stdout, no more threads
        return fail(Exit::environment, std::ferror(stdout) != 0 ? "standard output: cannot write" : error.what());
    } catch (const std::exception& error) {
        return fail(Exit::internal, error.what());
    } catch (...) {
        return fail(Exit::internal, "something was thrown that is not an exception; a library under test may do so");
    }
}

}  // namespace

int main(int argc, char** argv) {
    using namespace lostbits;
    // A library that LD_PRELOAD names was here before. Threads compute as the one that starts them.
    intersect::process::FloatingPoint::standard().set();
    analysis::shell::open_standard_streams();
    analysis::shell::install_signal_handlers();
    output::file::raise_open_file_limit();
    std::set_terminate(on_terminate);
    const int status = run_program(argc, argv);
    analysis::shell::tell_status(status);
    return status;
}
