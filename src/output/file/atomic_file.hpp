// Output files that exist whole or not at all.
#pragma once

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace lostbits::output::file {

/// Where a writer puts its bytes. The image module writes through this face, so that the one registry of
/// partial files and the one set of error messages live in the program and not a second time in the module.
class ByteSink {
public:
    virtual ~ByteSink() = default;

    /// Appends `bytes` at the current position. Throws EnvironmentError.
    virtual void write(std::span<const std::byte> bytes) = 0;

    /// Moves to `offset` bytes from the start; later writes overwrite. Throws EnvironmentError.
    virtual void seek(std::int64_t offset) = 0;

    /// The current position in bytes from the start.
    [[nodiscard]] virtual std::int64_t tell() const noexcept = 0;

    /// Flushes, closes and gives the file its final name. Throws EnvironmentError, and then nothing is left.
    virtual void commit() = 0;
};

/// A file that gets its final name only when it is whole.
///
/// Opened before the work starts, so that a run of an hour does not end on a folder that cannot be written.
/// Bytes go to `.<name>.partial-<drawn>` in the same folder, under a lock until `commit` has renamed it. Without
/// `commit` the destructor removes the temporary file; so does `remove_partial_files` from a signal handler; and what a
/// killed process left, which nobody locks, goes when that file is written again.
///
/// A final path that is a device or a pipe (`/dev/stdout`, `/dev/full`) is written directly, since a rename would
/// replace the device itself; one that is a symbolic link keeps the link and replaces its target.
class AtomicFile final : public ByteSink {
public:
    /// Makes missing parent folders and opens the temporary file. Throws EnvironmentError when the path is a
    /// folder, a parent is a file, or the folder or an existing file is not writable.
    explicit AtomicFile(const std::filesystem::path& path);
    ~AtomicFile() override;
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(std::span<const std::byte> bytes) override;
    void write(std::string_view text);
    void seek(std::int64_t offset) override;
    [[nodiscard]] std::int64_t tell() const noexcept override;

    /// As ByteSink says. Throws Interrupted when a signal handler has already removed the temporary file.
    void commit() override;

    /// The path as the caller gave it.
    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

private:
    void flush();
    void abandon() noexcept;
    [[noreturn]] void fail(const char* what, int error_number);

    std::filesystem::path path_;   // for messages
    std::filesystem::path final_;  // links resolved
    std::string partial_;          // empty when written directly
    std::atomic<char*>* slot_ = nullptr;
    int fd_ = -1;
    std::int64_t file_position_ = 0;  // where the descriptor stands; the buffer follows it
    std::size_t buffered_ = 0;
    std::unique_ptr<std::byte[]> buffer_;
};

/// A whole file of that text.
void write_file(const std::filesystem::path& path, std::string_view text);

/// Removes a temporary file that no living AtomicFile writes, of this process or another: whoever writes one holds a
/// lock on it (a process id says nothing, since two containers may both be process 1). Where the file system has no
/// locks it stays.
void remove_if_abandoned(const std::filesystem::path& partial) noexcept;

/// Removes the temporary file of every live AtomicFile of a process that is about to end. Async-signal-safe: atomics,
/// `poll` and `unlink` only. The files stay open, and their `commit` throws Interrupted, as a new AtomicFile does.
void remove_partial_files() noexcept;

/// From now on `listener` is told the name of every temporary file before it is made. No name comes twice.
void listen_to_partial_files(void (*listener)(const char* partial) noexcept) noexcept;

/// Raises the soft limit on open files to the hard one: a run holds a few files open for each form and format.
void raise_open_file_limit() noexcept;

/// Lets a write past RLIMIT_FSIZE fail with EFBIG, which is reported, rather than kill the process by SIGXFSZ.
void ignore_file_size_signal() noexcept;

// Of AtomicFile itself, in partial_files.cpp: the temporary files that this process is writing.

/// While one lives, its thread runs no signal handler, and one that removes the files waits for it: a file that is
/// created just behind the handler's back would stay (a run ended by SIGSEGV left one). Throws Interrupted where the
/// files have been removed.
class Creation {
public:
    Creation();
    ~Creation();
    Creation(const Creation&) = delete;
    Creation& operator=(const Creation&) = delete;

private:
    void leave() noexcept;
    sigset_t before_{};
};

/// Puts a name where a signal handler finds it.
std::atomic<char*>* register_partial(const std::string& partial);
/// True when this thread took the name back, false when a signal handler did (and removed the file).
bool unregister_partial(std::atomic<char*>* slot) noexcept;
/// Whether a file of that prefix, with so many letters behind it, is being written.
bool is_live(const std::string& prefix, std::size_t letters);

}  // namespace lostbits::output::file
