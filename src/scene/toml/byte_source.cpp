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

ByteSource::ByteSource(const std::filesystem::path& path, intersect::process::StopToken stop, Opens opens)
    : name_(path.string()), stop_(stop) {
    note_read(path);
    open(opens);
    struct stat status {};
    ::fstat(fd_, &status);
    if (S_ISREG(status.st_mode)) size_ = static_cast<std::uint64_t>(status.st_size);
    if (size_ || (opens == Opens::any && !S_ISDIR(status.st_mode))) return;
    ::close(fd_);
    throw InputError(name_ + (S_ISDIR(status.st_mode) ? ": is a folder; name a file in it"
                                                      : ": is a pipe or a device, but a file is needed here; write "
                                                        "its output to a file first"));
}

void ByteSource::open(Opens opens) {
    // `open` would wait for a pipe that nobody writes to. O_NONBLOCK changes nothing for a file.
    const int flags = O_RDONLY | O_CLOEXEC | (opens == Opens::files ? O_NONBLOCK : 0);
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
std::size_t ByteSource::fill(std::string& to, std::size_t most, const ReadSome& read_some) const {
    constexpr std::size_t first_piece = std::size_t{1} << 20;
    const std::size_t begin = to.size();
    // A file is usually shorter than a block, and clearing a buffer takes longer than reading into it. For a pipe the
    // buffer doubles each time it is full.
    to.resize(begin + static_cast<std::size_t>(std::min<std::uint64_t>(most, size_ ? *size_ + 1 : first_piece)));
    std::size_t got = 0;
    while (got < most) {
        stop_.check();
        if (begin + got == to.size()) to.resize(begin + std::min(most, std::max(first_piece, 2 * got)));
        const ssize_t n = read_some(to.data() + begin + got, to.size() - begin - got, got);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail(std::string("cannot read: ") + std::strerror(errno));
        if (n == 0) break;
        got += static_cast<std::size_t>(n);
    }
    to.resize(begin + got);
    return got;
}

std::size_t ByteSource::read(std::string& to, std::size_t most) {
    return fill(to, most, [this](char* buffer, std::size_t size, std::size_t) { return ::read(fd_, buffer, size); });
}

std::size_t ByteSource::read_at(std::uint64_t place, std::string& to, std::size_t most) const {
    return fill(to, most, [&](char* buffer, std::size_t size, std::size_t got) {
        return ::pread(fd_, buffer, size, static_cast<off_t>(place + got));
    });
}

}  // namespace lostbits::scene::toml
