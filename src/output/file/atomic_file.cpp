#include "output/file/atomic_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <system_error>

#include "intersect/process/process_state.hpp"
#include "number/error.hpp"
#include "output/file/result_folder.hpp"
#include "scene/toml/files_of_run.hpp"

namespace lostbits::output::file {
namespace {

constexpr std::size_t max_buffer_bytes = std::size_t{256} * 1024;

const char* remedy(int error_number) {
    switch (error_number) {
        case ENOSPC:
        case EDQUOT:
        case EFBIG: return "free space or choose another place";
        case EACCES:
        case EPERM:
        case EROFS: return "choose a place that you may write to";
        case ENOTDIR: return "a part of the path is a file; choose another place";
        case EISDIR: return "a folder has that name; choose another place";
        case EMFILE:
        case ENFILE: return "raise `ulimit -n` or select fewer forms";
        case ENAMETOOLONG: return "choose a shorter name";
        case ESPIPE: return "a pipe cannot hold this kind of file; give a file name";
        default: return "choose another place";
    }
}

[[noreturn]] void refuse(const std::filesystem::path& path, const char* failure, int error_number) {
    throw EnvironmentError(path.string() + ": " + failure + ": " + std::generic_category().message(error_number) +
                           "; " + remedy(error_number));
}

void make_parent(const std::filesystem::path& path) {
    const auto parent = path.parent_path();
    if (parent.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(parent, error);
    // Some versions of libstdc++ report success for a parent that exists as a file, so check again.
    struct stat info {};
    if (::stat(parent.c_str(), &info) == 0) {
        if (!S_ISDIR(info.st_mode)) refuse(parent, "cannot use as a folder", ENOTDIR);
        return;
    }
    refuse(parent, "cannot create the folder", error ? error.value() : errno);
}

/// Prefix `.NAME.partial-` of a temporary file. Random letters follow, not the process id: two containers that share a
/// folder may both be process 1.
std::string partial_prefix(const std::filesystem::path& final_path) {
    return (final_path.parent_path() / ("." + final_path.filename().string() + ".partial-")).string();
}

constexpr std::size_t random_letters = 12;  // 60 bits

std::string random_name() {
    std::array<unsigned char, random_letters> bytes{};
    // getrandom fails if the machine has not yet collected enough entropy, or lacks the call. The clock may then give a
    // name that is taken; open_new_file tries again.
    if (::getrandom(bytes.data(), bytes.size(), GRND_NONBLOCK) != static_cast<ssize_t>(bytes.size())) {
        const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<unsigned char>(now >> (5 * i));
    }
    std::string name;
    for (const unsigned char b : bytes) name += "abcdefghijklmnopqrstuvwxyz234567"[b % 32];
    return name;
}

/// Creates a new file that is locked for as long as it is open. Between its creation and its lock another process may
/// take it for abandoned and remove it; then the function creates another file. `make_name` returns a name and
/// registers it for the signal handler. `forget_name` removes a name from the registry if a file already has it.
int open_new_file(const std::function<std::string()>& make_name, const std::function<void()>& forget_name) {
    const CreationGuard creation;
    for (;;) {
        const int fd = ::open(make_name().c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd < 0 && errno != EEXIST) return fd;
        if (fd < 0) {
            forget_name();
            continue;
        }

        const bool is_locked = ::flock(fd, LOCK_EX | LOCK_NB) == 0;
        if (!is_locked && errno != EWOULDBLOCK) return fd;  // without locks, no other process removes the file
        // Another process that holds the lock is about to remove the file, even if its name is still there.
        struct stat info {};
        if (is_locked && (::fstat(fd, &info) != 0 || info.st_nlink > 0)) return fd;
        ::close(fd);
        forget_name();
    }
}

/// Removes the temporary files of this name that killed processes left. For a file in a folder of results, the run did
/// so when it began.
void remove_abandoned_neighbours(const std::filesystem::path& final_path) {
    if (is_in_own_folder(final_path)) return;
    const std::filesystem::path folder = final_path.has_parent_path() ? final_path.parent_path() : ".";
    const std::string prefix = std::filesystem::path(partial_prefix(final_path)).filename().string();
    std::error_code ignored;
    for (auto entry = std::filesystem::directory_iterator(folder, ignored); entry != std::filesystem::end(entry);
         entry.increment(ignored)) {
        if (entry->path().filename().string().starts_with(prefix)) remove_abandoned_file(entry->path());
    }
}

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& path) : path_(path), final_path_(path) {
    if (!path.has_filename()) refuse(path, "cannot write", EISDIR);

    // The target of a link is replaced, and not the link.
    struct stat info {};
    if (::lstat(path.c_str(), &info) == 0 && S_ISLNK(info.st_mode)) {
        std::error_code error;
        final_path_ = std::filesystem::weakly_canonical(path, error);
        if (error) refuse(path, "cannot follow the link", error.value());
    }

    require_own_result(path);
    intersect::process::restore_limits();
    make_parent(final_path_);

    // A device or a pipe is written directly.
    if (::stat(final_path_.c_str(), &info) == 0) {
        if (S_ISDIR(info.st_mode)) refuse(path, "cannot write", EISDIR);
        if (!S_ISREG(info.st_mode)) {
            fd_ = ::open(final_path_.c_str(), O_WRONLY | O_CLOEXEC);
            if (fd_ < 0) refuse(path, "cannot open", errno);
            return;
        }
        scene::toml::reserve_for_writing(final_path_);
        // A rename would replace a file that its owner made read-only.
        if (::access(final_path_.c_str(), W_OK) != 0) refuse(path, "cannot overwrite", errno);
    }
    open_partial_file();
}

void AtomicFile::open_partial_file() {
    const std::string prefix = partial_prefix(final_path_);
    if (is_being_written(prefix, random_letters)) throw std::logic_error(path_.string() + " is being written already");
    remove_abandoned_neighbours(final_path_);

    const auto forget_name = [this] {
        unregister_partial_file(registry_slot_);
        registry_slot_ = nullptr;
    };
    fd_ = open_new_file(
        [&] {
            partial_path_ = prefix + random_name();
            registry_slot_ = register_partial_file(partial_path_);
            return partial_path_;
        },
        forget_name);
    if (fd_ < 0) {
        const int error_number = errno;
        forget_name();
        refuse(path_, "cannot create", error_number);
    }
}

AtomicFile::~AtomicFile() { abandon(); }

void AtomicFile::abandon() noexcept {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
    buffer_.reset();
    buffered_bytes_ = 0;
    if (registry_slot_ != nullptr) {
        // Remove the file before its name leaves the registry. Otherwise a signal in between would leave the file.
        ::unlink(partial_path_.c_str());
        unregister_partial_file(registry_slot_);
    }
    registry_slot_ = nullptr;
}

void AtomicFile::fail(const char* failure, int error_number) {
    abandon();
    refuse(path_, failure, error_number);
}

void AtomicFile::flush() {
    if (buffered_bytes_ > 0) intersect::process::restore_limits();
    std::size_t written_bytes = 0;
    while (written_bytes < buffered_bytes_) {
        const ssize_t n = ::write(fd_, buffer_.get() + written_bytes, buffered_bytes_ - written_bytes);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail("cannot write", errno);
        if (n == 0) fail("cannot write", ENOSPC);
        written_bytes += static_cast<std::size_t>(n);
    }
    file_position_ += static_cast<std::int64_t>(buffered_bytes_);
    buffered_bytes_ = 0;
}

void AtomicFile::write(std::span<const std::byte> bytes) {
    if (fd_ < 0) throw std::logic_error(path_.string() + ": write after commit or failure");
    if (!buffer_) buffer_ = std::make_unique_for_overwrite<std::byte[]>(max_buffer_bytes);
    while (!bytes.empty()) {
        const std::size_t n = std::min(bytes.size(), max_buffer_bytes - buffered_bytes_);
        std::memcpy(buffer_.get() + buffered_bytes_, bytes.data(), n);
        buffered_bytes_ += n;
        bytes = bytes.subspan(n);
        if (buffered_bytes_ == max_buffer_bytes) flush();
    }
}

void AtomicFile::write(std::string_view text) { write(std::as_bytes(std::span(text))); }

void AtomicFile::seek(std::int64_t offset) {
    if (fd_ < 0) throw std::logic_error(path_.string() + ": seek after commit or failure");
    if (offset == tell()) return;
    flush();
    if (::lseek(fd_, offset, SEEK_SET) < 0) fail("cannot seek", errno);
    file_position_ = offset;
}

std::int64_t AtomicFile::tell() const noexcept { return file_position_ + static_cast<std::int64_t>(buffered_bytes_); }

void AtomicFile::commit() {
    if (fd_ < 0) throw std::logic_error(path_.string() + ": commit after commit or failure");
    flush();
    buffer_.reset();

    // The bytes must be on the disk before the file has its name: after a crash of the machine some file systems would
    // show an empty file. A map of 231 files took 1.93 s with this call and 1.88 s without (ext4 on a virtual disk).
    if (registry_slot_ != nullptr && ::fsync(fd_) != 0 && errno != EINVAL && errno != EROFS && errno != ENOTSUP)
        fail("cannot write", errno);

    // Keeps the lock until the file has its final name. Without it another run might take the file for abandoned.
    struct Lock {
        int fd;
        ~Lock() {
            if (fd >= 0) ::close(fd);
        }
    } const lock{::fcntl(fd_, F_DUPFD_CLOEXEC, 0)};
    // A network file system may report a full disk only here. After EINTR Linux has closed the descriptor.
    const int close_result = ::close(fd_);
    const int close_error = errno;
    fd_ = -1;
    if (close_result != 0 && close_error != EINTR) fail("cannot write", close_error);
    if (registry_slot_ != nullptr) rename_partial_file();
}

void AtomicFile::rename_partial_file() {
    const auto require_not_removed = [this] {
        if (registry_slot_->load() != nullptr) return;
        registry_slot_ = nullptr;
        throw Interrupted();
    };
    require_not_removed();
    note_result(path_);
    if (::rename(partial_path_.c_str(), final_path_.c_str()) != 0) {
        const int error_number = errno;
        require_not_removed();
        fail("cannot rename the finished file", error_number);
    }
    unregister_partial_file(registry_slot_);
    registry_slot_ = nullptr;
}

void write_file(const std::filesystem::path& path, std::string_view text) {
    AtomicFile file(path);
    file.write(text);
    file.commit();
}

void remove_abandoned_file(const std::filesystem::path& partial) noexcept {
    // The file is opened for writing too, because network file systems lock only such files.
    const int fd = ::open(partial.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (fd < 0) return;
    if (::flock(fd, LOCK_EX | LOCK_NB) == 0) ::unlink(partial.c_str());
    ::close(fd);
}

void raise_open_file_limit() noexcept {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == limit.rlim_max) return;
    limit.rlim_cur = limit.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &limit);
}

void ignore_file_size_signal() noexcept { std::signal(SIGXFSZ, SIG_IGN); }

}  // namespace lostbits::output::file
