// Folder for files of a test, which is removed at the end. ./run test fails if something stays in the temporary folder.
#pragma once

#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace lostbits::test {

namespace fs = std::filesystem;

inline std::string contents(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();  // by the block: character by character, tests that read pictures take four times as long
    return std::move(text).str();
}

/// A new folder, removed with all it holds.
class Scratch {
public:
    Scratch() {
        std::string name = (fs::temp_directory_path() / "lostbits-test-XXXXXX").string();
        if (!::mkdtemp(name.data())) throw std::runtime_error("no scratch folder");
        path_ = name;
    }
    ~Scratch() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    [[nodiscard]] const fs::path& path() const { return path_; }
    [[nodiscard]] fs::path operator/(const std::string& name) const { return path_ / name; }
    /// The path of a new file, whose folders are made too.
    std::string write(const std::string& name, const std::string& text) const {
        const fs::path file = path_ / name;
        fs::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << text;
        return file.string();
    }
    /// Every regular file below, hidden ones too, by path relative to the folder.
    [[nodiscard]] std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(path_)) {
            if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), path_).string());
        }
        std::ranges::sort(names);
        return names;
    }
    /// Number of files and folders directly inside.
    [[nodiscard]] std::size_t entries() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
    }

private:
    fs::path path_;
};

/// A file in a folder of its own.
class ScratchFile {
public:
    ScratchFile(const std::string& name, const std::string& text) : path_(folder_.write(name, text)) {}
    [[nodiscard]] const fs::path& path() const { return path_; }

private:
    Scratch folder_;
    fs::path path_;
};

}  // namespace lostbits::test
