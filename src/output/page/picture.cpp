#include "output/page/picture.hpp"

#include <fstream>
#include <sstream>

#include "intersect/device/temporary_folder.hpp"
#include "number/error.hpp"

namespace lostbits::output::page {

TemporaryFolder::TemporaryFolder() : path_(intersect::device::make_temporary_folder("lostbits-report")) {}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    if (!in) throw EnvironmentError(file.string() + ": could not be read back");
    return bytes.str();
}

Picture picture(std::string alt, const std::function<void(const std::filesystem::path&)>& draw) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "picture.png";
    draw(file);
    return {std::move(alt), bytes_of(file)};
}

Picture plot_picture(std::string alt, const std::function<void(const std::filesystem::path&)>& draw) {
    Picture plot = picture(std::move(alt), draw);
    plot.is_plot = true;
    return plot;
}

}  // namespace lostbits::output::page
