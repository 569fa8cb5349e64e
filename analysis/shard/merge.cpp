#include "analysis/shard/division.hpp"

#include <utility>

#include "analysis/selection/options.hpp"

namespace lostbits::analysis::shard {

namespace {

struct MergeOptions {
    std::vector<std::string> folders;
    std::string out;
    std::string junit, csv, json;  ///< for shards of `lostbits check` only
};

/// The arguments of the command whose shards are joined, with the folder of this run.
std::vector<std::string> make_run_arguments(const std::string& command, const MergeOptions& options) {
    std::vector<std::string> arguments = selection::split_shell_words(command);
    const bool is_check = arguments.size() > 1 && arguments[1] == "check";
    arguments.insert(arguments.end(), {is_check ? "--report" : "-o", options.out});
    for (const auto& [option, file] :
         {std::pair("--junit", options.junit), {"--export-csv", options.csv}, {"--export-json", options.json}}) {
        if (file.empty()) continue;
        if (!is_check)
            throw InputError(std::string(option) + " " + file + " is for claims, but these are shards of `" + command +
                             "`; leave out " + option);
        arguments.insert(arguments.end(), {option, file});
    }
    return arguments;
}

}  // namespace

void add_merge(const shell::Command& program, const std::string& version, const RunCommandAgain& run_again) {
    auto command =
        program.add_command("merge", "Join the shards of a run into the files that an unsharded run would write");
    const auto options = std::make_shared<MergeOptions>();
    command.add("FOLDER", options->folders, "Folders of shards, or folders that contain them, in any order").required();
    selection::add_out(command, options->out);
    command.add("--junit", options->junit, "Write JUnit XML, for claims");
    command.add("--export-csv", options->csv, "Write CSV, one row per claim");
    command.add("--export-json", options->json, "Write JSON, one object per claim");
    command.set_action([options, version, run_again] {
        const auto shards = std::make_shared<Shards>(options->folders, version);
        return run_again(make_run_arguments(shards->command(), *options), shards);
    });
}

}  // namespace lostbits::analysis::shard
