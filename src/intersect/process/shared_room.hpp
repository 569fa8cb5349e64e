// Memory that two processes share, so that columns of numbers go from one to the other without a copy by the system.
#pragma once

#include <cstddef>

namespace lostbits::intersect::process {

/// Whose turn it is in there, the two say to each other by other means.
class SharedRoom {
public:
    /// The descriptor by which a process that is started gets at the room of the one that starts it.
    static constexpr int inherited = 3;

    /// A new room; its descriptor is -1 where the system has none to give.
    SharedRoom();
    /// The room of the process that has started this one.
    explicit SharedRoom(int descriptor) : descriptor_(descriptor) {}
    ~SharedRoom();
    SharedRoom(const SharedRoom&) = delete;
    SharedRoom& operator=(const SharedRoom&) = delete;

    [[nodiscard]] int descriptor() const { return descriptor_; }
    /// So many bytes at least; what stood there stays. Null where there is no memory for them. What pointed into the
    /// room does no more.
    std::byte* with_bytes(std::size_t bytes);

private:
    int descriptor_ = -1;
    std::byte* base_ = nullptr;
    std::size_t mapped_ = 0;
};

}  // namespace lostbits::intersect::process
