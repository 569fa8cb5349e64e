// The files of a mended form: mend.csv (the form, the same with wider operations, the catalogue), minimal.csv (each of
// the operations, and what is left without it), mend.txt and datapackage.json.
#pragma once

#include <filesystem>

#include "output/mend/mend_rows.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::mend {

/// A row of minimal.csv: one of the operations that are done wider.
struct MinimalRow {
    std::string operation;
    int step;  ///< its place among the operations on what is not constant
    const measure::mend::Worth* without;
    bool meets;
};
/// mend.csv, whose rows are those of `rows_of`, and minimal.csv.
table::Table<FormRow> form_table();
table::Table<MinimalRow> minimal_table();
std::vector<MinimalRow> minimal_rows(const MendResult& result);

/// Opened before the work, named when it is whole.
class MendFiles {
public:
    explicit MendFiles(const std::filesystem::path& folder);
    void finish(const MendResult& result);
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
    table::TableFile<FormRow> forms_;
    table::TableFile<MinimalRow> minimal_;
};

/// A proposal as a header that holds `mended.NAME`, and what is to be compiled of it. `command` is what made it.
measure::mend::Written written(const MendResult& result, const Proposal& proposal, const std::string& name,
                               const std::string& command);

/// The best proposal under that file's name: `NAME.hpp` holds `mended.NAME`, `NAME.glsl` the function NAME. InputError
/// where none meets the wish, and as `shader_code`.
std::string emitted(const MendResult& result, const std::filesystem::path& file, const std::string& command);

}  // namespace lostbits::output::mend
