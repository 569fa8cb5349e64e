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
std::vector<std::string> arguments_of_run(const std::string& command, const MergeOptions& o) {
    std::vector<std::string> arguments = selection::split_shell_words(command);
    const bool is_check = arguments.size() > 1 && arguments[1] == "check";
    arguments.insert(arguments.end(), {is_check ? "--report" : "-o", o.out});
    for (const auto& [option, file] :
         {std::pair("--junit", o.junit), {"--export-csv", o.csv}, {"--export-json", o.json}}) {
        if (file.empty()) continue;
        if (!is_check)
            throw InputError(std::string(option) + " " + file + " is for claims, but these are shards of `" + command +
                             "`; leave out " + option);
        arguments.insert(arguments.end(), {option, file});
    }
    return arguments;
}

}  // namespace

void add_merge(const shell::Command& program, const std::string& version, const RunOfShards& run_again) {
    auto command =
        program.add_command("merge", "Join the shards of a run into the files that an unsharded run would write");
    const auto o = std::make_shared<MergeOptions>();
    command.add("DIR", o->folders, "Folders of shards, or folders that contain them, in any order").required();
    selection::add_out(command, o->out);
    command.add("--junit", o->junit, "Write JUnit XML, for claims");
    command.add("--export-csv", o->csv, "Write CSV, one row per claim");
    command.add("--export-json", o->json, "Write JSON, one object per claim");
    command.runs([o, version, run_again] {
        const auto shards = std::make_shared<Shards>(o->folders, version);
        return run_again(arguments_of_run(shards->command(), *o), shards);
    });
}

}  // namespace lostbits::analysis::shard
