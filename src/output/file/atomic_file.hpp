// Output files that exist complete or not at all.
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

/// Destination of the bytes of a writer. The image module writes through this interface, so the registry of partial
/// files and the error messages exist only in the program.
class ByteSink {
public:
    virtual ~ByteSink() = default;

    /// Appends `bytes` at the current position. Throws EnvironmentError.
    virtual void write(std::span<const std::byte> bytes) = 0;

    /// Moves to `offset` bytes from the start; later writes overwrite. Throws EnvironmentError.
    virtual void seek(std::int64_t offset) = 0;

    /// Current position in bytes from the start.
    [[nodiscard]] virtual std::int64_t tell() const noexcept = 0;

    /// Flushes and closes the file and gives it its final name. If it throws EnvironmentError, no file is left.
    virtual void commit() = 0;
};

/// A file that gets its final name only when it is complete.
///
/// It is opened before the work starts, so that a run of an hour does not fail at its end on a folder that cannot be
/// written. Bytes go to a temporary file `.<name>.partial-<random>` in the same folder, which is locked until `commit`
/// has renamed it. Without `commit` the destructor removes it, and `remove_partial_files` removes it from a signal
/// handler. A killed process leaves a temporary file without a lock, which is removed when the same file is written
/// again.
///
/// A device or a pipe (`/dev/stdout`, `/dev/full`) is written directly, since a rename would replace the device itself.
/// If the path is a symbolic link, the link stays and its target is replaced.
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

    /// See ByteSink. Throws Interrupted if a signal handler has already removed the temporary file.
    void commit() override;

    /// The path as the caller gave it.
    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

private:
    /// Creates the temporary file beside the final one.
    void open_partial_file();
    void flush();
    /// Gives the temporary file its final name. Throws Interrupted if a signal handler has removed it.
    void rename_partial_file();
    void abandon() noexcept;
    [[noreturn]] void fail(const char* failure, int error_number);

    std::filesystem::path path_;        // for messages
    std::filesystem::path final_path_;  // links resolved
    std::string partial_path_;          // empty when written directly
    std::atomic<char*>* registry_slot_ = nullptr;
    int fd_ = -1;
    std::int64_t file_position_ = 0;  // position of the descriptor; the bytes in the buffer follow it
    std::size_t buffered_bytes_ = 0;
    std::unique_ptr<std::byte[]> buffer_;
};

/// Writes `text` to a file.
void write_file(const std::filesystem::path& path, std::string_view text);

/// Removes a temporary file unless a living AtomicFile, of this process or another, is writing it: a writer holds a
/// lock on its file. (A process id proves nothing, since two containers may both be process 1.) If the file system has
/// no locks, the file stays.
void remove_abandoned_file(const std::filesystem::path& partial) noexcept;

/// Removes the temporary file of every live AtomicFile of a process that is about to end. Async-signal-safe: atomics,
/// `poll` and `unlink` only. The files stay open, and their `commit` throws Interrupted, as a new AtomicFile does.
void remove_partial_files() noexcept;

/// Calls `listener` with the name of every temporary file before it is created. No name comes twice.
void listen_to_partial_files(void (*listener)(const char* partial) noexcept) noexcept;

/// Raises the soft limit on open files to the hard one: a run holds a few files open for each form and format.
void raise_open_file_limit() noexcept;

/// Makes a write past RLIMIT_FSIZE fail with EFBIG, which is reported, instead of killing the process with SIGXFSZ.
void ignore_file_size_signal() noexcept;

// Only for AtomicFile, in partial_files.cpp: the registry of the temporary files that this process is writing.

/// Guards the creation of a temporary file. While a guard lives, its thread runs no signal handler, and a handler on
/// another thread that removes the temporary files waits for it. Otherwise a file created right after the removal
/// would stay (a run that was ended by SIGSEGV left one). Throws Interrupted if the files have been removed.
class CreationGuard {
public:
    CreationGuard();
    ~CreationGuard();
    CreationGuard(const CreationGuard&) = delete;
    CreationGuard& operator=(const CreationGuard&) = delete;

private:
    void end_creation() noexcept;
    sigset_t previous_mask_{};
};

/// Adds a name to the registry, where a signal handler finds it.
std::atomic<char*>* register_partial_file(const std::string& partial);
/// Removes a name from the registry. Returns false if a signal handler has already taken the name (and removed the
/// file).
bool unregister_partial_file(std::atomic<char*>* slot) noexcept;
/// True if this process is writing a file whose name is `prefix` and then this number of letters.
bool is_being_written(const std::string& prefix, std::size_t letter_count);

}  // namespace lostbits::output::file
