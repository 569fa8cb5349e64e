// Intersectors from outside, as the command line names them.
#pragma once

#include <string>
#include <vector>

#include "intersect/doors/contract.hpp"

namespace lostbits::analysis::choice {

/// Options of every command that takes forms.
struct DoorWords {
    std::vector<std::string> plugins;  ///< libraries, see `find_plugin`
    std::vector<std::string> pipes;    ///< commands for the shell
    bool isolate = false;              ///< libraries run in processes of their own
    double seconds = 30;               ///< that one batch may take
};

/// Loads and starts what is named; at most `threads` processes a command, 0 for one a core. InputError,
/// EnvironmentError.
std::vector<intersect::doors::ForeignForm> forms_behind(const DoorWords& words, int threads);

/// The same, and adds the forms to the table. Before any row is asked for.
void open_doors(const DoorWords& words, int threads);

/// The same words again, for a command that is to be run later: ` --plugin ./mine.so`.
std::string words_of_doors();

}  // namespace lostbits::analysis::choice
