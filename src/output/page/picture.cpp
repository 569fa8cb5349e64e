#include <fstream>
#include <sstream>

#include "intersect/device/temporary_folder.hpp"
#include "number/error.hpp"
#include "output/page/page.hpp"

namespace lostbits::output::page {

namespace {

/// The bytes of the file of that name that `draw` writes.
std::string drawn(const char* name, const std::function<void(const std::filesystem::path&)>& draw) {
    const intersect::device::TemporaryFolder folder("lostbits-report");
    const auto file = folder.path / name;
    draw(file);
    std::ifstream in(file, std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    if (!in)
        throw EnvironmentError(
            file.string() + ": the picture could not be read back; check that the disk for temporary files has space");
    return bytes.str();
}

}  // namespace

Picture picture(std::string alt, const std::function<void(const std::filesystem::path&)>& draw) {
    return {std::move(alt), drawn("picture.png", draw)};
}

Chart chart(std::string alt, const std::function<void(const std::filesystem::path&)>& draw, std::string name,
            bool is_plot) {
    return {std::move(alt), drawn("picture.svg", draw), std::move(name), is_plot};
}

}  // namespace lostbits::output::page
