#include "analysis/shell/table_on_stdout.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string_view>

#include "intersect/device/temporary_folder.hpp"
#include "number/error.hpp"

namespace lostbits::analysis::shell {

namespace fs = std::filesystem;

namespace {

constexpr std::array output_options{"--out", "--export-csv", "--export-json", "--junit"};

/// The tables of runs. The table of a run is the first of these that it wrote.
constexpr std::array<std::string_view, 9> table_names{"summary.csv", "samples.csv",    "cases.csv",
                                                      "worst.csv",   "statements.csv", "pareto.csv",
                                                      "choose.csv",  "mend.csv",       "claims.csv"};

}  // namespace

TableOnStdout::TableOnStdout(const Command& program) {
    const Command command = program.given_commands().back();
    command_ = command.name();
    Option table_option;
    for (const char* name : output_options) {
        const Option option = command.option(name);
        if (!option || option.given_values() != std::vector<std::string>{"-"}) continue;
        if (table_option) throw InputError(std::string(name) + " -: standard output takes one table, not two");
        table_option = option;
        is_folder_ = std::string_view(name) == "--out";
    }
    if (!table_option) return;

    if (is_folder_ && command_ == "report")
        throw InputError("-o -: a page is not a table; name a folder for index.html");
    if (const Option shard = command.option("--shard"); shard && !shard.given_values().empty())
        throw InputError(
            "-o -: a shard has no table; name the folder of the shards, and give -o - to `lostbits merge`");

    redirect(is_folder_);
    temporary_folder_ = intersect::device::make_temporary_folder("lostbits");
    table_option.replace({(is_folder_ ? temporary_folder_ : temporary_folder_ / "table").string()});
}

TableOnStdout::~TableOnStdout() {
    std::error_code ignored;
    if (!temporary_folder_.empty()) fs::remove_all(temporary_folder_, ignored);
}

void TableOnStdout::redirect(bool discards_text) {
    std::fflush(stdout);
    stdout_ = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    const int replacement = discards_text ? ::open("/dev/null", O_WRONLY | O_CLOEXEC) : STDERR_FILENO;
    if (stdout_ < 0 || replacement < 0 || dup2(replacement, STDOUT_FILENO) < 0)
        throw EnvironmentError("standard output: is closed, so the table cannot be written to it");
}

fs::path TableOnStdout::find_table() const {
    if (!is_folder_) return temporary_folder_ / "table";
    for (const std::string_view name : table_names) {
        std::vector<fs::path> found;
        for (const auto& entry : fs::recursive_directory_iterator(temporary_folder_)) {
            if (entry.path().filename() == name) found.push_back(entry.path());
        }
        if (found.size() > 1)
            throw InputError(
                fmt::format("-o -: standard output takes one table, and `{}` makes {}; name one subject, or give -o a "
                            "folder",
                            command_, found.size()));
        if (!found.empty()) return found.front();
    }
    throw InputError(fmt::format("-o -: `{}` has written no table; give -o a folder", command_));
}

void TableOnStdout::write() {
    if (temporary_folder_.empty()) return;
    std::fflush(stdout);
    if (dup2(stdout_, STDOUT_FILENO) < 0) throw EnvironmentError("standard output: cannot write");
    ::close(stdout_);
    const fs::path file = find_table();
    std::ifstream input(file, std::ios::binary);
    // If the reader has ended (`| head`), end with SIGPIPE, but remove the folder first.
    const auto previous_handler = std::signal(SIGPIPE, SIG_IGN);
    std::array<char, 65536> bytes{};
    while (input.read(bytes.data(), bytes.size()), input.gcount() > 0)
        std::fwrite(bytes.data(), 1, static_cast<std::size_t>(input.gcount()), stdout);
    const bool reader_is_gone = std::fflush(stdout) != 0 && errno == EPIPE;
    std::signal(SIGPIPE, previous_handler);
    if (!reader_is_gone || previous_handler == SIG_IGN) return;
    std::error_code ignored;
    fs::remove_all(temporary_folder_, ignored);
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
}

}  // namespace lostbits::analysis::shell
