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
    std::vector<std::string> plugins;    ///< libraries, see `find_plugin`, each with an optional NAME= before it
    std::vector<std::string> pipes;      ///< commands for the shell
    std::vector<std::string> shaders;    ///< files of GLSL, see `read_shader`
    std::vector<std::string> functions;  ///< of C, C++, Rust, shaders and LLVM IR, see `load_function`
    std::vector<std::string> devices;    ///< for the shaders: `device_kinds` or `all`; empty: the first available
    bool isolate = false;                ///< every library runs in its own process, even one with formulas
    bool in_process = false;             ///< no library runs in its own process
    bool isolate_by_default = false;  ///< libraries without formulas run in their own process, see `decide_isolation`
    bool quiet = false;               ///< the guessed signatures of functions are not shown
    double seconds = 30;              ///< time limit of one batch
    intersect::process::StopToken stop = {};  ///< ends the wait for an answer
    /// Called with the exit status if a fault of a library ends the program; also from signal handlers.
    void (*on_fatal_fault)(int status) = nullptr;
};

/// The forms of external intersectors, and their formulas. A form with a formula may be in both lists.
struct ExternalForms {
    std::vector<intersect::external::ForeignForm> forms;
    std::vector<intersect::external::Formula> formulas;  ///< empty for libraries in other processes
};

/// Sets `isolate_by_default`. Without --isolate and --in-process, libraries are isolated if the command is a gate
/// (which `check` is) or if CI is set in the environment.
void decide_isolation(ExternalOptions& options, bool is_gate);

/// The libraries that run in this process, as one text with commas between them; empty if every library has a process
/// of its own. Throws InputError.
std::string libraries_in_process(const ExternalOptions& options);

/// Prints notes on stderr if libraries are isolated by default: which ones run in this process all the same and, if
/// `measures_times`, that the times of the others include the way to their process and back.
void note_isolation(const ExternalOptions& options, bool measures_times);

/// A shell command that runs this program with these arguments. Throws EnvironmentError.
std::string this_program(const std::string& arguments);

/// The devices of these names, each once; `all` stands for every kind of device. Without names, one empty name, which
/// stands for the first available device. Throws InputError.
std::vector<std::string> select_devices(const std::vector<std::string>& names);

/// Loads the libraries and starts the processes that the options name: at most `threads` processes per command, 0 for
/// one per core. Sets `output::attribution::plugin_options`, with which advice on later commands names the same
/// intersectors. Throws InputError and EnvironmentError.
ExternalForms load_external_forms(const ExternalOptions& options, int thread_count);

/// Calls `load_external_forms` and adds the forms to the table. Call it before any row of the table is used.
void open_external(const ExternalOptions& options, int thread_count);

/// Compiles a function of the user and prints on stderr what its arguments are taken for. Call `load_external_forms`
/// before.
std::unique_ptr<intersect::function::UserFunction> load_shown_function(const std::string& function_name,
                                                                       const ExternalOptions& options);

/// Prints on stderr which libraries change the floating-point state of the processor when they are loaded.
void note_processor_states();

/// The patterns of -i; without -i, `defaults` and the names of all external forms.
std::vector<std::string> form_patterns(const std::vector<std::string>& given, std::vector<std::string> defaults);

/// Prints a note on stderr if -i and --against of the parsed command name none of the external forms.
void note_unused_external_forms(const shell::Command& command);

/// Prints on stderr, unless `quiet`, which wanted forms are not measured because nothing has their
/// shape or format. A form is wanted if a pattern of -i is its name, or if it is external and either -i is not given or
/// a pattern of -i matches its name.
void note_unmeasured(const std::vector<std::string>& patterns,
                     const std::vector<measure::evaluate::TestedForm>& tested_forms, bool quiet);

/// The answers of a device about itself.
struct DeviceReport {
    std::string kind;
    std::vector<std::pair<std::string, std::string>> facts;
    std::string problem;  ///< why the device cannot compute; empty if it can
};

/// Starts a driver in a process of its own, asks how it rounds, and ends it. The answer must come within
/// `options.seconds`. A driver that crashes or hangs counts as missing.
DeviceReport ask_device(std::string_view kind, const ExternalOptions& options);

}  // namespace lostbits::analysis::selection
