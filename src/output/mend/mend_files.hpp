// The files of a mended form: mend.csv (the form, the same with wider operations, the catalogue), minimal.csv (each of
// the operations, and what is left without it), mend.txt and datapackage.json.
#pragma once

#include <filesystem>

#include "output/file/csv.hpp"
#include "output/mend/mend_text.hpp"

namespace lostbits::output::mend {

/// Opened before the work, named when it is whole.
class MendFiles {
public:
    explicit MendFiles(const std::filesystem::path& folder);
    void finish(const MendResult& result);
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
    file::CsvWriter forms_, minimal_;
};

/// A proposal as a header that holds `mended.NAME`. `command` is what made it.
std::string header_of(const MendResult& result, const Proposal& proposal, const std::string& name,
                      const std::string& command);

/// The best proposal as a header of that file's name: `NAME.hpp` holds `mended.NAME`. InputError where none meets the
/// wish.
std::string emitted(const MendResult& result, const std::filesystem::path& file, const std::string& command);

}  // namespace lostbits::output::mend
