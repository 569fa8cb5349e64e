// The file of a shard or of a stopped run: the run that it belongs to, and its results so far.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "measure/shard/share.hpp"
#include "output/file/atomic_file.hpp"
#include "output/shard/bits.hpp"

namespace lostbits::output::shard {

/// Name of the file in the folder of a shard.
inline constexpr const char* state_file_name = "shard.state";

/// The run that a shard belongs to. Shards of one run differ only in their number.
struct StateHead {
    std::string program;       ///< `lostbits 0.1.0`
    std::string command;       ///< the command of the run, without options that do not change results
    std::uint64_t inputs = 0;  ///< `InputHash` of the files that the run reads
    measure::shard::Share share = {};
};

/// FNV-1a, 64 bits: h ← (h xor byte)·1099511628211 from 14695981039346656037 on. It detects accidental differences
/// between files, not deliberate ones.
class InputHash {
public:
    void add(std::string_view bytes);
    /// Adds the contents of a file. Throws EnvironmentError if the file cannot be read.
    void add_file(const std::filesystem::path& path);
    [[nodiscard]] std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 14695981039346656037U;
};

/// Writes a state file: a head as lines of text, then records (a name, a size and bits), then the hash of everything
/// before it. The file gets its final name when it is complete.
class StateFileWriter {
public:
    StateFileWriter(const std::filesystem::path& path, const StateHead& head);
    /// Adds a record. Threads may call it at the same time; records are stored in the order of the calls.
    void put(std::string_view name, std::string_view bits);
    void close();

private:
    void write(std::string_view bytes);

    file::AtomicFile file_;
    InputHash hash_;
    std::mutex mutex_;
};

/// Reads a state file record by record. Throws InputError, with the path and `damage_text`, if the file is
/// not a state file or was changed. The file is open only from the first call of `next` until `pause`, so that a
/// thousand readers do not keep a thousand files open.
class StateFileReader {
public:
    explicit StateFileReader(std::filesystem::path path,
                             std::string damage_text = "is damaged, or not the file of a shard; run that shard again");
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] const StateHead& head() const { return head_; }

    /// The names of the records in the file's order; consecutive records of the same name count as one.
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

    /// Passes the bits of the next record to `read_record` if the record has this name; otherwise returns false.
    /// Throws InputError if `read_record` needs more bits, leaves some, or throws std::out_of_range.
    [[nodiscard]] bool next(std::string_view name, const std::function<void(BitReader&)>& read_record);
    /// Closes the file until the next call of `next`, which continues at the same record.
    void pause() { in_.close(); }
    /// True if all records were read.
    [[nodiscard]] bool is_at_end() const { return position_ == end_; }
    /// Throws the InputError for a damaged file.
    [[noreturn]] void fail_damaged() const;

private:
    void require_matching_hash();
    void read_head();
    void read_names();
    std::uint64_t read_number();
    std::string read_line(std::string_view name);
    std::string read_bytes(std::uint64_t size);

    std::filesystem::path path_;
    std::string damage_text_;
    std::ifstream in_;
    StateHead head_;
    std::vector<std::string> names_;
    std::uint64_t position_ = 0, end_ = 0;
};

/// The file that --resume continues from: the state of a stopped run, as its only record.
class UnfinishedFile {
public:
    /// `folder` is the folder of the results, `head` the run that the file belongs to, and `job` the name of the
    /// record.
    UnfinishedFile(const std::filesystem::path& folder, StateHead head, std::string job)
        : path_(folder / "unfinished.state"), head_(std::move(head)), job_(std::move(job)) {}
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] bool exists() const { return std::filesystem::exists(path_); }

    void write(std::string_view bits) const;
    /// Passes the bits to `read_record`, as `StateFileReader::next` does. Throws InputError if the file does not
    /// exist, if it belongs to another run (the message says what differs), or if it is damaged.
    void read(const std::function<void(BitReader&)>& read_record) const;

private:
    std::filesystem::path path_;
    StateHead head_;
    std::string job_;
};

}  // namespace lostbits::output::shard
