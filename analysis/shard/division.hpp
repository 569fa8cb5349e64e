// Divides the work of a run. There are three kinds of run: a whole run, one shard of several, and the run of `lostbits
// merge`, which joins finished shards: it runs their command once more, but reads their measurements instead of
// measuring.
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

/// Parses `3/64`. Throws InputError for a text that is not a shard.
measure::shard::Share parse_share(const std::string& text);

/// Name of a shard's folder inside the folder of its run: `shard-3-of-64`.
std::string folder_name(measure::shard::Share share);

/// All shards of one run, in their order.
class Shards {
public:
    /// Opens the shards in the folders. Each folder has one shard, or subfolders with one shard each. Throws InputError
    /// if a shard is missing, is there twice, or belongs to another run.
    explicit Shards(const std::vector<std::string>& folders, const std::string& program);

    [[nodiscard]] const std::string& command() const { return files_.front().head().command; }
    [[nodiscard]] std::uint64_t size() const { return files_.size(); }
    /// Throws InputError if the files of the run have changed since the shards read them.
    void require_same_inputs(std::uint64_t input_count) const;
    /// Throws InputError if a shard has other jobs than these. Call it before any result is written.
    void require_same_jobs(const std::vector<std::string>& jobs) const;
    /// Calls `visit` for every record of this name, one shard after another.
    void for_each_record(const std::string& name, const std::function<void(output::shard::BitReader&)>& visit);
    /// Throws InputError if a shard has records that were not read.
    void require_end() const;

private:
    void require_same_run(const std::string& program) const;
    void require_complete() const;

    std::vector<output::shard::StateFileReader> files_;
};

/// The part of the work that a process does, and the records that it writes or joins.
class Division {
public:
    /// A whole run.
    Division() = default;
    /// A shard. Its file appears in the folder when it is finished.
    Division(const std::filesystem::path& folder, const output::shard::StateHead& head);
    /// A run that joins shards.
    explicit Division(std::shared_ptr<Shards> shards) : shards_to_join_(std::move(shards)) {}

    /// The share of the work that this run does.
    [[nodiscard]] measure::shard::Share share() const { return share_; }
    [[nodiscard]] bool is_shard() const { return file_ != nullptr; }
    [[nodiscard]] bool joins() const { return shards_to_join_ != nullptr; }

    /// In a shard, its units out of the `count()` units of the run. Nothing in other runs, which do not call `count`.
    template <class Count>
    [[nodiscard]] std::optional<measure::shard::UnitRange> units_of_shard(const Count& count) const {
        return is_shard() ? std::optional(share_.unit_range(count())) : std::nullopt;
    }

    /// Records what a shard found, under the name of a job. Call it only in a shard.
    template <class... T>
    void put(const std::string& job, const T&... results) {
        file_->put(job, output::shard::bits_of(results...));
    }
    /// Calls `visit` for the records of the job, in the order of the shards. Call it only in a run that joins shards.
    void for_each_record(const std::string& job, const std::function<void(output::shard::BitReader&)>& visit) {
        shards_to_join_->for_each_record(job, visit);
    }

    /// The result of a job: measured here, or joined from the records of the shards. A shard calls `measure`, records
    /// the result as its part of the job, and returns nothing. `measure` takes no arguments; it measures only the units
    /// of work that belong to `share()`. `require_part` throws std::out_of_range if a record cannot be a part of the
    /// job.
    template <class Measure>
    auto measure_or_join(const std::string& job, const Measure& measure,
                         const std::function<void(const std::invoke_result_t<Measure>&)>& require_part = {})
        -> std::optional<std::invoke_result_t<Measure>> {
        using Result = std::invoke_result_t<Measure>;
        if (joins()) {
            std::optional<Result> all;
            for_each_record(job, [&](output::shard::BitReader& bits) {
                Result part{};
                bits(part);
                if (require_part) require_part(part);
                if (all) append(*all, std::move(part));
                else all = std::move(part);
            });
            return all;
        }
        Result result = measure();
        if (!is_shard()) return result;
        put(job, result);
        return std::nullopt;
    }

    /// Names all jobs of the run. Throws InputError if shards that are joined have other jobs.
    void require_same_jobs(const std::vector<std::string>& jobs) const {
        if (shards_to_join_) shards_to_join_->require_same_jobs(jobs);
    }

    /// Ends the run: the file of a shard gets its final name.
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
    std::shared_ptr<Shards> shards_to_join_;
};

/// Runs the command that the arguments name, with the measurements of the shards in place of its own.
using RunCommandAgain = std::function<ExitStatus(std::vector<std::string> arguments, std::shared_ptr<Shards> shards)>;

/// Registers the subcommand; `version` is the program's.
void add_merge(const shell::Command& program, const std::string& version, const RunCommandAgain& run_again);

}  // namespace lostbits::analysis::shard
