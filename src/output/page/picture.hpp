// A picture of the laboratory as bytes, for a page that holds it.
#pragma once

#include <filesystem>
#include <functional>

#include "output/page/page.hpp"

namespace lostbits::output::page {

/// A folder of its own under the system's folder for temporary files, removed with all that is in it.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// What is in a file. EnvironmentError when it cannot be read.
[[nodiscard]] std::string bytes_of(const std::filesystem::path& file);

/// What `draw` writes into the file that it is given.
[[nodiscard]] Picture picture(std::string alt, const std::function<void(const std::filesystem::path&)>& draw);
/// The same of lines or points, which a dark page turns over.
[[nodiscard]] Picture plot_picture(std::string alt, const std::function<void(const std::filesystem::path&)>& draw);

}  // namespace lostbits::output::page
