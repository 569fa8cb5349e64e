#include <fstream>
#include <sstream>

#include "intersect/device/temporary_folder.hpp"
#include "number/error.hpp"
#include "output/report/page.hpp"

namespace lostbits::output::report {

Picture picture(std::string alt, const std::function<void(const std::filesystem::path&)>& draw) {
    const intersect::device::TemporaryFolder folder("lostbits-report");
    const auto file = folder.path / "picture.png";
    draw(file);
    std::ifstream in(file, std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    if (!in)
        throw EnvironmentError(
            file.string() + ": the picture could not be read back; check that the disk for temporary files has space");
    return {std::move(alt), bytes.str()};
}

}  // namespace lostbits::output::report
