// `-o -`: the table of a run on standard output, and nothing else.
#pragma once

#include <filesystem>
#include <string>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::shell {

/// Where an output is called `-`, the run writes into a folder of its own that goes away, and its table goes to
/// standard output. What else the run says there goes to standard error, and the names of files in that folder nowhere.
class TableOnStdout {
public:
    /// Looks for `-` among the outputs of the command that was named. InputError where two are.
    explicit TableOnStdout(const Command& program);
    ~TableOnStdout();
    TableOnStdout(const TableOnStdout&) = delete;
    TableOnStdout& operator=(const TableOnStdout&) = delete;

    /// Writes the table. InputError where the run made several, or none.
    void write();

private:
    void redirect(bool to_nothing);
    [[nodiscard]] std::filesystem::path table() const;

    std::string command_;
    bool is_folder_ = false;
    std::filesystem::path scratch_;  // empty: nothing is called `-`
    int stdout_ = -1;                // the descriptor that was standard output
};

}  // namespace lostbits::analysis::shell
