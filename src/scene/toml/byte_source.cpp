#include "scene/toml/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "number/error.hpp"
#include "scene/toml/files_of_run.hpp"

namespace lostbits::scene::toml {

ByteSource::ByteSource(const std::filesystem::path& path, intersect::process::StopToken stop,
                       AllowedFiles allowed_files)
    : name_(path.string()), stop_(stop) {
    reserve_for_reading(path);
    open(allowed_files);
    struct stat status {};
    ::fstat(fd_, &status);
    if (S_ISREG(status.st_mode)) size_ = static_cast<std::uint64_t>(status.st_size);
    if (size_ || (allowed_files == AllowedFiles::any && !S_ISDIR(status.st_mode))) return;
    ::close(fd_);
    throw InputError(name_ + (S_ISDIR(status.st_mode) ? ": is a folder; name a file in it"
                                                      : ": is a pipe or a device, but a file is needed here; write "
                                                        "its output to a file first"));
}

void ByteSource::open(AllowedFiles allowed_files) {
    // Without O_NONBLOCK, `open` would wait for a pipe that no process writes to. O_NONBLOCK has no effect on a file.
    const int flags = O_RDONLY | O_CLOEXEC | (allowed_files == AllowedFiles::files ? O_NONBLOCK : 0);
    do {
        stop_.check();
        fd_ = ::open(name_.c_str(), flags);
    } while (fd_ < 0 && errno == EINTR);
    if (fd_ >= 0) return;
    const int error = errno;
    if (error == ENOENT || error == ENOTDIR)
        throw InputError(name_ + ": no such file; check its name and the current folder");
    if (error == ELOOP || error == ENAMETOOLONG || error == ENXIO)
        throw InputError(name_ + ": is not a file: " + std::strerror(error) + "; name one");
    fail(std::string("cannot open: ") + std::strerror(error));
}

ByteSource::~ByteSource() { ::close(fd_); }

void ByteSource::fail(const std::string& what) const { throw EnvironmentError(name_ + ": " + what); }

template <class ReadSome>
std::size_t ByteSource::fill(std::string& buffer, std::size_t max_bytes, const ReadSome& read_some) const {
    constexpr std::size_t first_piece = std::size_t{1} << 20;
    const std::size_t begin = buffer.size();
    // A file is usually shorter than a block, and clearing a buffer takes longer than reading into it. For a pipe the
    // buffer doubles each time it is full.
    buffer.resize(begin +
                  static_cast<std::size_t>(std::min<std::uint64_t>(max_bytes, size_ ? *size_ + 1 : first_piece)));
    std::size_t bytes_read = 0;
    while (bytes_read < max_bytes) {
        stop_.check();
        if (begin + bytes_read == buffer.size())
            buffer.resize(begin + std::min(max_bytes, std::max(first_piece, 2 * bytes_read)));
        const ssize_t n = read_some(buffer.data() + begin + bytes_read, buffer.size() - begin - bytes_read, bytes_read);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail(std::string("cannot read: ") + std::strerror(errno));
        if (n == 0) break;
        bytes_read += static_cast<std::size_t>(n);
    }
    buffer.resize(begin + bytes_read);
    return bytes_read;
}

std::size_t ByteSource::read(std::string& buffer, std::size_t max_bytes) {
    return fill(buffer, max_bytes,
                [this](char* destination, std::size_t size, std::size_t) { return ::read(fd_, destination, size); });
}

std::size_t ByteSource::read_at(std::uint64_t offset, std::string& buffer, std::size_t max_bytes) const {
    return fill(buffer, max_bytes, [&](char* destination, std::size_t size, std::size_t bytes_read) {
        return ::pread(fd_, destination, size, static_cast<off_t>(offset + bytes_read));
    });
}

}  // namespace lostbits::scene::toml
