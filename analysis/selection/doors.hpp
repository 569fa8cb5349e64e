// Intersectors from outside, as the command line names them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/shell/command_line.hpp"
#include "intersect/doors/contract.hpp"
#include "intersect/doors/formulas.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/evaluate/evaluate.hpp"

namespace lostbits::analysis::selection {

/// Options of every command that takes forms.
struct DoorWords {
    std::vector<std::string> plugins;  ///< libraries, see `find_plugin`, perhaps with NAME= before them
    std::vector<std::string> pipes;    ///< commands for the shell
    std::vector<std::string> shaders;  ///< files of GLSL, see `read_shader`
    std::vector<std::string> devices;  ///< that run them, of `device_kinds` or `all`; empty: the first that there is
    bool isolate = false;              ///< libraries run in processes of their own, those of formulas too
    bool in_process = false;           ///< none does
    bool isolate_by_default = false;   ///< those without formulas do, see `decide_where`
    double seconds = 30;               ///< that one batch may take
    intersect::process::StopToken stop = {};  ///< ends the wait for an answer
    /// Told the status where a fault of a library ends the program; from signal handlers, too.
    void (*ends_with)(int status) = nullptr;
};

/// What stands behind the doors: forms that answer, and those of them that are formulas.
struct Behind {
    std::vector<intersect::doors::ForeignForm> forms;
    std::vector<intersect::doors::Formula> formulas;  ///< none of libraries in other processes
};

/// Where neither --isolate nor --in-process says it: a process of their own for libraries of a gate, which is `check`,
/// and every command where CI is set in the environment.
void decide_where(DoorWords& words, bool is_gate);

/// Which libraries run in this program itself, in one text; empty where none does. InputError.
std::string loaded_here(const DoorWords& words);

/// Says on stderr which libraries run in the program although others are isolated, and that times are not the
/// library's own where they are isolated by default and `times` are measured.
void note_where(const DoorWords& words, bool times);

/// A command for the shell that runs this program with these words. EnvironmentError.
std::string this_program(const std::string& words);

/// The devices that the words name, without repetition; empty: the first that there is. InputError.
std::vector<std::string> devices_of(const std::vector<std::string>& words);

/// Loads and starts what is named; at most `threads` processes a command, 0 for one a core. Commands that are to be run
/// later name the same again, see `output::blame::where_forms_are_from`. InputError, EnvironmentError.
Behind open_each(const DoorWords& words, int threads);

/// The same, and adds the forms to the table. Before any row is asked for.
void open_doors(const DoorWords& words, int threads);

/// Says on stderr which libraries leave the processor another than they find it when they are loaded.
void note_states();

/// The words of -i; where there are none, `defaults` and the names of all forms that were added.
std::vector<std::string> form_words_or(const std::vector<std::string>& given, std::vector<std::string> defaults);

/// Says on stderr where -i and --against, of a command that was parsed, name none of the forms that were added.
void note_unasked(const shell::Command& command);

/// Says on stderr, unless `quiet`, which forms that `words` of -i name in full, or that were added and are asked for,
/// are in none of the rows that are measured: their shape or their formats fit nothing.
void note_unmeasured(const std::vector<std::string>& words, const std::vector<measure::evaluate::TestedForm>& rows,
                     bool quiet);

/// A device as its process told it.
struct DeviceTold {
    std::string kind;
    std::vector<std::pair<std::string, std::string>> facts;
    std::string lacks;  ///< why it does not compute; empty where it does
};

/// Starts a driver, asks it how it rounds within the seconds of the words, and ends it. A driver that crashes or hangs
/// is one that is not here.
DeviceTold ask_device(std::string_view kind, const DoorWords& words);

}  // namespace lostbits::analysis::selection
