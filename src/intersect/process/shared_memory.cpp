#include "intersect/process/shared_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

namespace lostbits::intersect::process {

SharedMemory::SharedMemory() : descriptor_(memfd_create("lostbits", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
    // The other process runs foreign code and must not shrink the memory: reading a mapped page that is gone is a
    // SIGBUS.
    if (descriptor_ >= 0) static_cast<void>(fcntl(descriptor_, F_ADD_SEALS, F_SEAL_SHRINK));
}

SharedMemory::~SharedMemory() {
    if (base_ != nullptr) munmap(base_, mapped_);
    if (descriptor_ >= 0) close(descriptor_);
}

std::byte* SharedMemory::grow_to(std::size_t byte_count) {
    if (byte_count <= mapped_) return base_;
    struct stat info {};
    if (fstat(descriptor_, &info) != 0) return nullptr;
    const std::size_t size = std::max({byte_count, 2 * mapped_, static_cast<std::size_t>(info.st_size)});
    if (size > static_cast<std::size_t>(info.st_size) && ftruncate(descriptor_, static_cast<off_t>(size)) != 0)
        return nullptr;
    void* const mapping = base_ == nullptr ? mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0)
                                           : mremap(base_, mapped_, size, MREMAP_MAYMOVE);
    if (mapping == MAP_FAILED) return nullptr;
    base_ = static_cast<std::byte*>(mapping);
    mapped_ = size;
    return base_;
}

}  // namespace lostbits::intersect::process
