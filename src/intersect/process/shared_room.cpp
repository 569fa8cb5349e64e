#include "intersect/process/shared_room.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

namespace lostbits::intersect::process {

SharedRoom::SharedRoom() : descriptor_(memfd_create("lostbits", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
    // The other process runs foreign code. It must not shrink the memory: reading a mapped page that is gone is a
    // SIGBUS.
    if (descriptor_ >= 0) static_cast<void>(fcntl(descriptor_, F_ADD_SEALS, F_SEAL_SHRINK));
}

SharedRoom::~SharedRoom() {
    if (base_ != nullptr) munmap(base_, mapped_);
    if (descriptor_ >= 0) close(descriptor_);
}

std::byte* SharedRoom::with_bytes(std::size_t bytes) {
    if (bytes <= mapped_) return base_;
    struct stat info {};
    if (fstat(descriptor_, &info) != 0) return nullptr;
    const std::size_t room = std::max({bytes, 2 * mapped_, static_cast<std::size_t>(info.st_size)});
    if (room > static_cast<std::size_t>(info.st_size) && ftruncate(descriptor_, static_cast<off_t>(room)) != 0)
        return nullptr;
    void* const place = base_ == nullptr ? mmap(nullptr, room, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0)
                                         : mremap(base_, mapped_, room, MREMAP_MAYMOVE);
    if (place == MAP_FAILED) return nullptr;
    base_ = static_cast<std::byte*>(place);
    mapped_ = room;
    return base_;
}

}  // namespace lostbits::intersect::process
