#include "analysis/shell/different_files.hpp"

#include <fmt/format.h>

#include <map>

#include "number/error.hpp"

namespace lostbits::analysis::shell {

std::filesystem::path place_of(const std::string& file) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file));
}

void require_different_files(const std::vector<NamedFile>& files, const NamedFile& folder) {
    const auto taken_folder = folder.file.empty() ? std::filesystem::path() : place_of(folder.file);
    std::map<std::filesystem::path, const char*> taken;
    for (const auto& [option, file] : files) {
        if (file.empty()) continue;
        const auto at = place_of(file);
        if (!taken_folder.empty() && at.parent_path() == taken_folder)
            throw InputError(fmt::format("{} {}: lies among the files of {} {}; put it elsewhere", option, file,
                                         folder.option, folder.file));
        const auto [place, fresh] = taken.emplace(at, option);
        if (!fresh)
            throw InputError(
                fmt::format("{} {}: {} names the same file; give each a file of its own", option, file, place->second));
    }
}

}  // namespace lostbits::analysis::shell
