// The file of a shard, or of a run that was stopped: what it is a part of, and what it found.
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

/// In the folder of a shard.
inline constexpr const char* state_file_name = "shard.state";

/// What a shard is a part of. Shards of one run differ in their number alone.
struct StateHead {
    std::string program;       ///< `lostbits 0.1.0`
    std::string command;       ///< the run as it would be typed, without what changes no result
    std::uint64_t inputs = 0;  ///< `InputHash` of the files that the run reads
    measure::shard::Share share = {};
};

/// FNV-1a, 64 bits: h ← (h xor byte)·1099511628211 from 14695981039346656037 on. It tells files apart that differ by
/// accident, not by intent.
class InputHash {
public:
    void add(std::string_view bytes);
    /// The contents of a file. EnvironmentError where it cannot be read.
    void add_file(const std::filesystem::path& path);
    [[nodiscard]] std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 14695981039346656037U;
};

/// Writes a head as lines of text, then records: a name, a size and bits. At the end stands the hash of all that is in
/// front of it. The file has its name when it is whole.
class StateFileWriter {
public:
    StateFileWriter(const std::filesystem::path& path, const StateHead& head);
    /// By one thread at a time: records of several threads stand in the order of their coming.
    void put(std::string_view name, std::string_view bits);
    void close();

private:
    void write(std::string_view bytes);

    file::AtomicFile file_;
    InputHash hash_;
    std::mutex mutex_;
};

/// Reads it record by record. InputError, with the path and `damaged`, for what is not such a file or was changed. The
/// file is open from the first record that is asked for until `rest`, so that a thousand of them do not all hold one.
class StateFileReader {
public:
    explicit StateFileReader(std::filesystem::path path,
                             std::string damaged = "is damaged, or not the file of a shard; run that shard again");
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] const StateHead& head() const { return head_; }

    /// The names of its records in their order; one for all that stand together.
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

    /// Hands on the bits of the next record, where it has this name. InputError where `take` needs more of them, leaves
    /// some, or throws std::out_of_range.
    [[nodiscard]] bool next(std::string_view name, const std::function<void(BitReader&)>& take);
    /// Closes the file; the next record stays the next.
    void rest() { in_.close(); }
    /// Whether all records were read.
    [[nodiscard]] bool is_at_end() const { return at_ == end_; }
    [[noreturn]] void damaged() const;

private:
    void check_hash();
    void read_head();
    void read_names();
    std::uint64_t number();
    std::string line(std::string_view name);
    std::string bytes(std::uint64_t size);

    std::filesystem::path path_;
    std::string damaged_;
    std::ifstream in_;
    StateHead head_;
    std::vector<std::string> names_;
    std::uint64_t at_ = 0, end_ = 0;
};

/// How far a part of a run came before it was stopped, as its only record: what --resume goes on from.
class UnfinishedFile {
public:
    /// In the folder of its results; `head` is what it is a part of, and `job` the name of the record.
    UnfinishedFile(const std::filesystem::path& folder, StateHead head, std::string job)
        : path_(folder / "unfinished.state"), head_(std::move(head)), job_(std::move(job)) {}
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] bool is_there() const { return std::filesystem::exists(path_); }

    void write(std::string_view bits) const;
    /// Hands the bits to `take`, as `StateFileReader::next` does. InputError where there is no such file, where it is
    /// of another run (it says what differs), or where it is damaged.
    void read(const std::function<void(BitReader&)>& take) const;

private:
    std::filesystem::path path_;
    StateHead head_;
    std::string job_;
};

}  // namespace lostbits::output::shard
