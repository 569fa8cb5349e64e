#include "scene/dump/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "number/error.hpp"
#include "scene/toml/files_of_run.hpp"

namespace lostbits::scene::dump {

ByteSource::ByteSource(const std::filesystem::path& path, intersect::process::StopToken stop)
    : name_(path.string()), stop_(stop) {
    toml::note_read(path);
    fd_ = ::open(name_.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd_ < 0) {
        const int error = errno;
        if (error == ENOENT || error == ENOTDIR)
            throw InputError(name_ + ": there is no such file; look at its name and the folder you are in");
        if (error == ELOOP || error == ENAMETOOLONG)
            throw InputError(name_ + ": cannot be followed: " + std::strerror(error) + "; check the path");
        fail(std::string("cannot open: ") + std::strerror(error));
    }
    struct stat status {};
    ::fstat(fd_, &status);
    if (S_ISDIR(status.st_mode)) {
        ::close(fd_);
        throw InputError(name_ + ": is a folder; name a file of rays in it");
    }
    if (S_ISREG(status.st_mode)) size_ = static_cast<std::uint64_t>(status.st_size);
}

ByteSource::~ByteSource() { ::close(fd_); }

void ByteSource::fail(const std::string& what) const { throw EnvironmentError(name_ + ": " + what); }

template <class ReadSome>
std::size_t ByteSource::fill(std::string& to, std::size_t most, const ReadSome& read_some) const {
    const std::size_t begin = to.size();
    // A file is most often shorter than a block of it, and clearing room takes longer than reading.
    to.resize(begin + static_cast<std::size_t>(std::min<std::uint64_t>(most, size_.value_or(most) + 1)));
    std::size_t got = 0;
    while (got < most) {
        stop_.check();
        if (begin + got == to.size()) to.resize(begin + most);
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
    return fill(to, most, [this](char* room, std::size_t size, std::size_t) { return ::read(fd_, room, size); });
}

std::size_t ByteSource::read_at(std::uint64_t place, std::string& to, std::size_t most) const {
    return fill(to, most, [&](char* room, std::size_t size, std::size_t got) {
        return ::pread(fd_, room, size, static_cast<off_t>(place + got));
    });
}

}  // namespace lostbits::scene::dump
