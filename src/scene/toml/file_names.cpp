#include "scene/toml/file_names.hpp"

#include <algorithm>
#include <optional>
#include <system_error>
#include <vector>

#include "number/error.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::scene::toml {

std::string result_name(const std::filesystem::path& file) {
    std::string name = file.stem().string();
    if (name.starts_with('.'))
        throw InputError(
            file.string() +
            ": results are named after the file without its ending, but the file name is only an ending; rename it "
            "to start with a letter");
    if (std::ranges::any_of(name, [](unsigned char c) { return c < ' ' || c == 0x7F; }))
        throw InputError(file.string() +
                         ": results are named after the file without its ending, and this name has a line break or "
                         "another control character; rename it");
    return name;
}

std::string suggest_file(const std::filesystem::path& path) {
    std::vector<std::string> names;
    std::error_code ignored;
    const auto folder = path.parent_path();
    for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder, ignored)) {
        if (entry.path().extension() == ".toml" && entry.path().filename() != path.filename())
            names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    const std::string name = path.filename().string();
    const bool lacks_ending = std::ranges::find(names, name + ".toml") != names.end();
    const auto closest_name = lacks_ending ? std::optional(name + ".toml") : text::closest(name, names);
    return closest_name ? "did you mean \"" + (folder / *closest_name).string() + "\"?" : "";
}

std::string error_phrase(const std::filesystem::filesystem_error& error) {
    const std::string path = error.path1().string();
    return (path.empty() ? "a path" : path) + ": the system cannot resolve it: " + error.code().message() +
           "; check the path, and the links on it";
}

std::filesystem::path find_data_folder(const std::filesystem::path& data_dir, const std::string& folder_name) {
    const std::filesystem::path folder = data_dir / folder_name;
    std::error_code error;
    const auto status = std::filesystem::status(folder, error);
    if (std::filesystem::is_directory(status)) return folder;
    const bool is_missing = status.type() == std::filesystem::file_type::not_found;
    throw InputError(
        folder.string() +
        (is_missing ? ": this folder does not exist; run in the project folder, or " : ": is not a folder; ") +
        "name the folder that contains " + folder_name + "/ with --data, or in LOSTBITS_DATA");
}

}  // namespace lostbits::scene::toml
