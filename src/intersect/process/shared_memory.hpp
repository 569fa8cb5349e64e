// Memory that two processes share, so that columns of numbers go from one to the other without a copy by the system.
#pragma once

#include <cstddef>

namespace lostbits::intersect::process {

/// The two processes agree by other means which of them may use the memory next.
class SharedMemory {
public:
    /// The descriptor by which a started process inherits the memory of its parent.
    static constexpr int inherited = 3;

    /// Makes new shared memory; its descriptor is -1 if the system has no memory to give.
    SharedMemory();
    /// Opens the memory of the parent process.
    explicit SharedMemory(int descriptor) : descriptor_(descriptor) {}
    ~SharedMemory();
    SharedMemory(const SharedMemory&) = delete;
    SharedMemory& operator=(const SharedMemory&) = delete;

    [[nodiscard]] int descriptor() const { return descriptor_; }
    /// Grows the memory to at least this many bytes; the contents stay. Null if there is not enough memory. Earlier
    /// pointers into the memory become invalid.
    std::byte* grow_to(std::size_t byte_count);

private:
    int descriptor_ = -1;
    std::byte* base_ = nullptr;
    std::size_t mapped_ = 0;
};

}  // namespace lostbits::intersect::process
