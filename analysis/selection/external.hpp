// External intersectors (libraries, pipes, shaders), as the command line names them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/shell/command_line.hpp"
#include "intersect/external/contract.hpp"
#include "intersect/external/formulas.hpp"
#include "intersect/function/function.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/evaluate/evaluate.hpp"

namespace lostbits::analysis::selection {

/// The options for external intersectors, which every command with forms takes.
struct ExternalOptions {
    std::vector<std::string> plugins;         ///< libraries, see `find_plugin`, each with an optional NAME= before it
    std::vector<std::string> pipes;           ///< commands for the shell
    std::vector<std::string> shaders;         ///< files of GLSL, see `read_shader`
    std::vector<std::string> functions;       ///< of C, C++, Rust, shaders and LLVM IR, see `load_function`
    std::vector<std::string> devices;         ///< for the shaders: `device_kinds` or `all`; empty: the first available
    bool isolate = false;                     ///< every library runs in its own process, even one with formulas
    bool in_process = false;                  ///< no library runs in its own process
    bool isolate_by_default = false;          ///< libraries without formulas run in their own, see `decide_where`
    bool quiet = false;                       ///< the guessed signatures of functions are not shown
    double seconds = 30;                      ///< time limit of one batch
    intersect::process::StopToken stop = {};  ///< ends the wait for an answer
    /// Called with the exit status if a fault of a library ends the program; also from signal handlers.
    void (*ends_with)(int status) = nullptr;
};

/// The forms of external intersectors, and their formulas. A form with a formula may be in both lists.
struct ExternalForms {
    std::vector<intersect::external::ForeignForm> forms;
    std::vector<intersect::external::Formula> formulas;  ///< empty for libraries in other processes
};

/// Sets `isolate_by_default`. Without --isolate and --in-process, libraries are isolated if the command is a gate
/// (which `check` is) or if CI is set in the environment.
void decide_where(ExternalOptions& words, bool is_gate);

/// The libraries that run in this process, as one text; empty if there are none. Throws InputError.
std::string loaded_here(const ExternalOptions& words);

/// Prints notes on stderr if libraries are isolated by default: which ones run in this process all the same and, if the
/// command measures `times`, that the times of the others include the way to their process and back.
void note_where(const ExternalOptions& words, bool times);

/// A shell command that runs this program with these words. Throws EnvironmentError.
std::string this_program(const std::string& words);

/// The devices that the words name, each once; one empty name (the first available device) without words. Throws
/// InputError.
std::vector<std::string> devices_of(const std::vector<std::string>& words);

/// Loads the libraries and starts the processes that are named: at most `threads` processes per command, 0 for one per
/// core. Advice with commands to run later names the same intersectors, see
/// `output::attribution::plugin_options`. Throws InputError and EnvironmentError.
ExternalForms open_each(const ExternalOptions& words, int threads);

/// Calls `open_each` and adds the forms to the table. Call it before any row of the table is used.
void open_external(const ExternalOptions& words, int threads);

/// Compiles a function of the user and prints on stderr what its arguments are taken for. Call `open_each` before.
std::unique_ptr<intersect::function::UserFunction> load_shown_function(const std::string& named,
                                                                       const ExternalOptions& words);

/// Prints on stderr which libraries change the floating-point state of the processor when they are loaded.
void note_states();

/// The words of -i; without any, `defaults` and the names of all external forms.
std::vector<std::string> form_words_or(const std::vector<std::string>& given, std::vector<std::string> defaults);

/// Prints a note on stderr if -i and --against of the parsed command name none of the external forms.
void note_unasked(const shell::Command& command);

/// Prints on stderr, unless `quiet`, which wanted forms are in none of the measured rows because nothing has their
/// shape or format. A form is wanted if a word of -i is its name, or if it is external and -i is not given or matches
/// it.
void note_unmeasured(const std::vector<std::string>& words, const std::vector<measure::evaluate::TestedForm>& rows,
                     bool quiet);

/// The answers of a device about itself.
struct DeviceReport {
    std::string kind;
    std::vector<std::pair<std::string, std::string>> facts;
    std::string lacks;  ///< why the device cannot compute; empty if it can
};

/// Starts a driver in a process, asks it how it rounds, within the seconds of the words, and ends it. A driver that
/// crashes or hangs counts as missing.
DeviceReport ask_device(std::string_view kind, const ExternalOptions& words);

}  // namespace lostbits::analysis::selection
