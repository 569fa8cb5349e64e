// Writes the table of a run to standard output, and nothing else (`-o -`).
#pragma once

#include <filesystem>
#include <string>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::shell {

/// If an output is called `-`, the run writes into a temporary folder, and its table goes to standard output. If the
/// output is a file, other text on standard output goes to standard error; if it is a folder, that text, which names
/// files in the temporary folder, is dropped.
class TableOnStdout {
public:
    /// Looks for `-` among the outputs of the given command. Throws InputError if there are two.
    explicit TableOnStdout(const Command& program);
    ~TableOnStdout();
    TableOnStdout(const TableOnStdout&) = delete;
    TableOnStdout& operator=(const TableOnStdout&) = delete;

    /// Writes the table. Throws InputError if the run made several, or none.
    void write();

private:
    void redirect(bool discards_text);
    [[nodiscard]] std::filesystem::path find_table() const;

    std::string command_;
    bool is_folder_ = false;
    std::filesystem::path temporary_folder_;  // empty: no output is called `-`
    int stdout_ = -1;                         // the descriptor that was standard output
};

}  // namespace lostbits::analysis::shell
