// How the work of a run is divided: not at all, into shards of which this run is one, or shards are done and joined, by
// `lostbits merge`: the command whose shards lie there runs once more, with everything measured.
#pragma once

#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "analysis/shell/command_line.hpp"
#include "measure/shard/share.hpp"
#include "number/error.hpp"
#include "output/shard/fields.hpp"
#include "output/shard/state_file.hpp"

namespace lostbits::analysis::shard {

/// `3/64`. InputError for anything that is not a shard.
measure::shard::Share share_named(const std::string& word);

/// The folder of a shard in that of its run: `shard-3-of-64`.
std::string folder_name(measure::shard::Share share);

/// All shards of one run, in their order.
class Shards {
public:
    /// What lies in the folders: each has a shard, or folders that have one each. InputError where a shard is missing,
    /// is there twice, or is one of another run.
    explicit Shards(const std::vector<std::string>& folders, const std::string& program);

    [[nodiscard]] const std::string& command() const { return files_.front().head().command; }
    [[nodiscard]] std::uint64_t size() const { return files_.size(); }
    /// InputError where the run's files are no longer those that the shards read.
    void check_inputs(std::uint64_t inputs) const;
    /// InputError where a shard has other jobs than these: before a result is written, not after the last.
    void check_jobs(const std::vector<std::string>& jobs) const;
    /// Every record of this name, of one shard after another.
    void each(const std::string& name, const std::function<void(output::shard::BitReader&)>& take);
    /// InputError where a shard has more than was asked for.
    void check_end() const;

private:
    void check_same_run(const std::string& program) const;
    void check_complete() const;

    std::vector<output::shard::StateFileReader> files_;
};

class Division {
public:
    /// Not at all.
    Division() = default;
    /// This run is a shard, whose file is in the folder once it is finished.
    Division(const std::filesystem::path& folder, const output::shard::StateHead& head);
    /// All is measured.
    explicit Division(std::shared_ptr<Shards> joined) : joined_(std::move(joined)) {}

    /// Of this run.
    [[nodiscard]] measure::shard::Share share() const { return share_; }
    [[nodiscard]] bool is_shard() const { return file_ != nullptr; }
    [[nodiscard]] bool joins() const { return joined_ != nullptr; }

    /// Of a shard: notes what it found under the name of a job.
    template <class... T>
    void put(const std::string& job, const T&... found) {
        file_->put(job, output::shard::bits_of(found...));
    }
    /// Where shards are joined: what they noted, in their order.
    void each(const std::string& job, const std::function<void(output::shard::BitReader&)>& take) {
        joined_->each(job, take);
    }

    /// What a job comes to: measured here, or joined from what the shards measured. Nothing in a shard, which notes
    /// its part. `measure` measures what `share` has; `require` of a shard's part throws std::out_of_range where it
    /// cannot be one.
    template <class Measure>
    auto result_of(const std::string& job, const Measure& measure,
                   const std::function<void(const std::invoke_result_t<Measure>&)>& require = {})
        -> std::optional<std::invoke_result_t<Measure>> {
        using Result = std::invoke_result_t<Measure>;
        if (joins()) {
            std::optional<Result> all;
            each(job, [&](output::shard::BitReader& bits) {
                Result part{};
                bits(part);
                if (require) require(part);
                if (all) append(*all, std::move(part));
                else all = std::move(part);
            });
            return all;
        }
        Result here = measure();
        if (!is_shard()) return here;
        put(job, here);
        return std::nullopt;
    }

    /// All jobs of the run.
    void expect(const std::vector<std::string>& jobs) const {
        if (joined_) joined_->check_jobs(jobs);
    }

    /// The end of the run: a shard's file gets its name.
    void finish();

private:
    template <class Result>
    static void append(Result& all, Result&& part) {
        all.append(std::move(part));
    }
    template <class Item>
    static void append(std::vector<Item>& all, std::vector<Item>&& part) {
        all.insert(all.end(), std::move_iterator(part.begin()), std::move_iterator(part.end()));
    }

    measure::shard::Share share_ = {};
    std::unique_ptr<output::shard::StateFileWriter> file_;
    std::shared_ptr<Shards> joined_;
};

/// Runs the command of these words, of which the shards have measured everything.
using RunOfShards = std::function<Exit(std::vector<std::string> words, std::shared_ptr<Shards> shards)>;

/// Registers the subcommand; `version` is the program's.
void add_merge(const shell::Command& program, const std::string& version, const RunOfShards& run_again);

}  // namespace lostbits::analysis::shard
