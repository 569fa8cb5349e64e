// A mended form in words, what is done wider, what that keeps, that nothing can be taken from it, and how far it holds;
// and its files: mend.csv (the form, the same with wider operations, the catalogue), minimal.csv (each of the
// operations, and what is left without it), mend.txt and datapackage.json.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "measure/mend/mend.hpp"
#include "measure/mend/price.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::mend {

/// All that is known of a mended form.
struct MendResult {
    const measure::mend::MendRequest& request;
    const measure::mend::Mended& mended;
    /// The forms of the catalogue for the same solids in the same format, most accurate first, and what they are worth.
    std::vector<measure::evaluate::TestedForm> catalogue;
    std::vector<measure::mend::Worth> catalogue_worth;
    std::vector<measure::choice::Room> rooms = {};  ///< of the form with its set
    /// Of each way of writing it; empty of one that fails the wish.
    std::vector<std::vector<measure::choice::Room>> rewritten_rooms = {};
    /// The form, the set if there is one, each way of writing it, the catalogue; empty where nothing was timed.
    std::vector<measure::mend::Price> prices = {};
    std::string no_price = {};  ///< why nothing was timed although it was asked for

    [[nodiscard]] bool has_set() const { return mended.set && !mended.set->operations.empty(); }
};

/// What was found, the catalogue beside it and how far all of it holds; without prices.
MendResult result_of(const measure::mend::MendRequest& request, const measure::mend::Mended& mended);

/// A form that came out: the set, or a way of writing it.
struct Proposal {
    Tape tape;
    const measure::mend::Worth* worth;
    const measure::mend::Rewritten* rewritten;    ///< null: the set
    const measure::mend::Price* price = nullptr;  ///< null: it was not timed
};
/// The set first, if there is one.
std::vector<Proposal> proposals_of(const MendResult& result);
/// The one to take: of those that meet the wish the fastest in packs; where nothing was timed a way of writing it, the
/// one with fewest operations, before the set. Null where none does.
const Proposal* best_of(const std::vector<Proposal>& proposals, const measure::choice::Wish& wish);
/// `cross products, stable roots`
std::string rules_of(const measure::mend::Rewritten& rewritten);
/// `3 of its 15 operations in double`, `written another way: cross products`
std::string how_in_words(const MendResult& result, const Proposal& proposal);
/// The names of what the set does wider: `c, disc`.
std::string names_of_set(const MendResult& result);

/// `double`, `two floats`, `two doubles`.
std::string name_of_wider(const FloatFormat& wider);
/// `c = dot(o - centre, o - centre) - radius*radius`: an operation of the form's tape as the source has it.
std::string operation_in_words(const MendResult& result, NodeId operation);
/// The statements of the form that change, as a diff has them.
std::vector<std::string> changed_lines(const MendResult& result, const Tape& now);
/// The answer, several lines.
std::string in_words(const MendResult& result);

/// A row of mend.csv, and of what stands beside each other in the plot and in words: the form, what came of it, the
/// catalogue.
struct FormRow {
    std::string_view kind;              ///< own, wider, all_wider, rewritten, catalogue
    std::string name;                   ///< `sphere.half_b`, `3 of 20 in double`, `cross products, stable roots`
    measure::evaluate::TestedForm row;  ///< of the catalogue its own, else the form's
    std::size_t operations = 0;         ///< that round; 0 for the catalogue
    std::size_t wide = 0;               ///< so many of them are done wider
    const measure::mend::Worth* worth = nullptr;
    const measure::mend::Worth* apart = nullptr;  ///< on rays on which nothing was searched; null where not asked
    std::string rules = {};                       ///< that rewrote it
    std::string wider = {};                       ///< what is done in a wider format is done in this
    bool meets = false;                           ///< the wish
    const measure::mend::Price* price = nullptr;  ///< null: it was not timed
    bool front = false;  ///< it was timed, and nothing is at least as accurate and as fast, and better in one
    bool told = true;    ///< of the catalogue only the most accurate and the front are, and not the form itself

    [[nodiscard]] bool came_out() const { return kind == "wider" || kind == "rewritten"; }
};

/// The form, the set if there is one, all operations wider, each way of writing it, the catalogue.
std::vector<FormRow> rows_of(const MendResult& result);

/// `c, disc in double: 12.0 → 22.1 bits, no wrong decision, +0.3 ns a ray`: what a row that came out changes.
std::string change_in_words(const MendResult& result, const FormRow& row);

/// Kept bits of all rows against their time in packs; where nothing was timed, against the operations done wider.
void write_front_plot(const std::filesystem::path& path, const MendResult& result);

/// A row of minimal.csv: one of the operations that are done wider.
struct MinimalRow {
    std::string operation;
    int step;  ///< its place among the operations on what is not constant
    const measure::mend::Worth* without;
    bool meets;
};
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
