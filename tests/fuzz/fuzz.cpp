#include "fuzz/fuzz.hpp"

#include <sys/mman.h>
#include <unistd.h>

namespace lostbits::fuzz {

std::filesystem::path file_of(std::string_view bytes) {
    static const int file = memfd_create("input", 0);
    if (file < 0 || ftruncate(file, 0) != 0) throw std::runtime_error("no file in memory");
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t written = pwrite(file, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
        if (written <= 0) throw std::runtime_error("the file in memory takes no more");
        done += static_cast<std::size_t>(written);
    }
    return "/proc/self/fd/" + std::to_string(file);
}

}  // namespace lostbits::fuzz
