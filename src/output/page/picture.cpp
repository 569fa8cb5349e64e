#include <fstream>
#include <sstream>

#include "intersect/device/temporary_folder.hpp"
#include "number/error.hpp"
#include "output/page/page.hpp"

namespace lostbits::output::page {

namespace {

/// A folder of its own under the system's folder for temporary files, removed with all that is in it.
struct TemporaryFolder {
    const std::filesystem::path path = intersect::device::make_temporary_folder("lostbits-report");

    TemporaryFolder() = default;
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
};

}  // namespace

Picture picture(std::string alt, const std::function<void(const std::filesystem::path&)>& draw, bool is_plot) {
    const TemporaryFolder folder;
    const auto file = folder.path / "picture.png";
    draw(file);
    std::ifstream in(file, std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    if (!in) throw EnvironmentError(file.string() + ": could not be read back");
    return {std::move(alt), bytes.str(), is_plot};
}

}  // namespace lostbits::output::page
