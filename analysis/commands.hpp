// The subcommands: each adds itself to the program and runs when it is chosen.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <string>

#include "number/error.hpp"
#include "output/file/progress.hpp"

namespace lostbits::analysis {

/// Options of every command.
struct Common {
    std::string data;  ///< the data folder, see `data_folder`
    output::file::Progress::Mode progress = output::file::Progress::Mode::automatic;
    bool quiet = false;
    bool verbose = false;
    int threads = 0;  ///< 0: one per core
    std::string isa;  ///< a name of `isa_names`; empty: the best that the processor has
};

using Command = std::function<Exit()>;

/// Each registers a subcommand and stores in `chosen` what to run when it was given.
void add_check(CLI::App& program, const Common& common, Command& chosen);
void add_diff(CLI::App& program, const Common& common, Command& chosen);
void add_explain(CLI::App& program, const Common& common, Command& chosen);
void add_list(CLI::App& program, const Common& common, Command& chosen);
void add_map(CLI::App& program, const Common& common, Command& chosen);
void add_render(CLI::App& program, const Common& common, Command& chosen);
void add_report(CLI::App& program, const Common& common, Command& chosen);
void add_sweep(CLI::App& program, const Common& common, Command& chosen);
void add_trade(CLI::App& program, const Common& common, Command& chosen);

}  // namespace lostbits::analysis
