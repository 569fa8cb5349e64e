#include <fmt/format.h>

#include <memory>
#include <utility>

#include "analysis/choice/options.hpp"
#include "analysis/shard/division.hpp"
#include "commands.hpp"

namespace lostbits::analysis {

namespace {

struct MergeOptions {
    std::vector<std::string> folders;
    std::string out;
    std::string junit, csv, json;  ///< of claims
};

/// The words of the run whose shards these are, with a place of its own and how this command is to run.
std::vector<std::string> words_of_run(const std::string& command, const MergeOptions& o, const Common& common) {
    std::vector<std::string> words = choice::words_in(command);
    const bool checks = words.size() > 1 && words[1] == "check";
    words.insert(words.end(), {checks ? "--report" : "-o", o.out});
    for (const auto& [option, file] :
         {std::pair("--junit", o.junit), {"--export-csv", o.csv}, {"--export-json", o.json}}) {
        if (file.empty()) continue;
        if (!checks)
            throw InputError(std::string(option) + " " + file + ": is for claims, and these are shards of `" + command +
                             "`; leave it out");
        words.insert(words.end(), {option, file});
    }
    if (common.quiet) words.emplace_back("-q");
    if (common.verbose) words.emplace_back("-v");
    if (common.force) words.emplace_back("--force");
    if (common.threads > 0) words.insert(words.end(), {"-j", std::to_string(common.threads)});
    if (!common.isa.empty()) words.insert(words.end(), {"--isa", common.isa});
    words.insert(words.end(), {"--progress", "none"});
    return words;
}

}  // namespace

void add_merge(CLI::App& program, const Common& common, Command& chosen, const RunOfShards& run_again) {
    auto* command = program.add_subcommand("merge", "Shards of a run joined: the same files as the whole run writes");
    const auto o = std::make_shared<MergeOptions>();
    command->add_option("DIR", o->folders, "Folders of shards, or folders that hold them, in any order")->required();
    command->add_option("-o,--out", o->out, "Folder for the results")->required();
    command->add_option("--junit", o->junit, "Of claims: write JUnit XML");
    command->add_option("--export-csv", o->csv, "Of claims: write CSV, one row per claim");
    command->add_option("--export-json", o->json, "Of claims: write JSON, one object per claim");
    command->callback([o, &common, &chosen, run_again] {
        chosen = [o, &common, run_again] {
            require_folder(o->out);
            const auto shards = std::make_shared<shard::Shards>(o->folders, program_and_version);
            return run_again(words_of_run(shards->command(), *o, common), shards);
        };
    });
}

}  // namespace lostbits::analysis
