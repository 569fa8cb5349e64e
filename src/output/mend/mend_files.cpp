#include "output/mend/mend_files.hpp"

#include <fmt/format.h>

#include "number/error.hpp"
#include "output/choice/choice_text.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/datapackage.hpp"
#include "output/mend/form_code.hpp"

namespace lostbits::output::mend {

using file::Cell;
using file::Column;
using file::number_or_missing;
using measure::mend::Worth;

namespace {

const std::vector<Column> form_columns{
    {"kind", "string", "",
     "own: the form; wider: the smallest set of its operations wider; all_wider: all of them; catalogue"},
    {"form", "string", "", "form"},
    {"format", "string", "", "of its inputs and answers"},
    {"wider", "string", "", "what wider operations are done in; missing where none is"},
    {"wider_operations", "integer", "", "so many of its operations are done wider; missing for the catalogue"},
    {"operations", "integer", "", "that round; missing for the catalogue"},
    {"rays", "integer", "", "whose truth is known"},
    {"true_hits", "integer", "", "rays that truly hit"},
    {"wrong", "integer", "", "false hits, false misses, NaNs and hits of another solid"},
    {"wrong_fraction", "number", "1", "wrong/rays"},
    {"kept_bits", "number", "bits", "significand bits less what is lost, at the wish's share of the agreed hits"},
    {"meets", "boolean", "", "whether it meets the wish"},
    {"apart_rays", "integer", "", "rays on which nothing was searched; missing where they were not asked"},
    {"apart_wrong", "integer", "", "of these, decided wrongly"},
    {"apart_kept_bits", "number", "bits", "kept on these"}};

const std::vector<Column> minimal_columns{
    {"operation", "string", "", "of the set, as the source names it; it alone is done as it was, the others wider"},
    {"rays", "integer", "", "whose truth is known"},
    {"wrong", "integer", "", "decided wrongly without it"},
    {"kept_bits", "number", "bits", "kept without it"},
    {"meets", "boolean", "", "whether the wish is met without it: 0, or the set would not be minimal"}};

class Rows {
public:
    Rows(file::CsvWriter& csv, const MendResult& r) : csv_(csv), r_(r) {}

    void of_form(const char* kind, std::size_t wide, const Worth& worth, const Worth* apart) {
        const std::string wider = name_of_wider(r_.mended.wider);
        start(kind, r_.request.row);
        csv_.add(wide == 0 ? Cell() : Cell(wider)).add(wide).add(r_.mended.operations);
        finish(worth, apart);
    }
    void of_catalogue(const measure::map::MapRow& row, const Worth& worth) {
        start("catalogue", row);
        csv_.add({}).add({}).add({});
        finish(worth, nullptr);
    }

private:
    void start(const char* kind, const measure::map::MapRow& row) {
        csv_.add(kind).add(row.form->info->name).add(row.format.name);
    }
    void finish(const Worth& w, const Worth* apart) {
        csv_.add(w.rays).add(w.hits).add(w.wrong).add(w.wrong_fraction()).add(number_or_missing(w.kept_bits));
        csv_.add(w.meets(r_.request.wish));
        csv_.add(apart ? Cell(apart->rays) : Cell()).add(apart ? Cell(apart->wrong) : Cell());
        csv_.add(apart ? number_or_missing(apart->kept_bits) : Cell()).end_row();
    }

    file::CsvWriter& csv_;
    const MendResult& r_;
};

}  // namespace

MendFiles::MendFiles(const std::filesystem::path& folder)
    : folder_(folder), forms_(folder / "mend.csv", form_columns), minimal_(folder / "minimal.csv", minimal_columns) {}

void MendFiles::finish(const MendResult& r) {
    const auto& m = r.mended;
    Rows rows(forms_, r);
    const bool wider = m.set && !m.set->operations.empty();
    rows.of_form("own", 0, m.own, &m.own_apart);
    if (wider) rows.of_form("wider", m.set->operations.size(), m.set->worth, &m.apart_worth);
    rows.of_form("all_wider", m.operations, m.all, m.set ? nullptr : &m.apart_worth);
    for (std::size_t k = 0; k < r.catalogue.size(); ++k) rows.of_catalogue(r.catalogue[k], r.catalogue_worth[k]);
    for (std::size_t k = 0; wider && k < m.set->operations.size(); ++k) {
        const Worth& w = m.set->without[k];
        minimal_.row({operation_in_words(r, m.set->operations[k]), w.rays, w.wrong, number_or_missing(w.kept_bits),
                      w.meets(r.request.wish)});
    }
    forms_.close();
    minimal_.close();
    file::AtomicFile text(folder_ / "mend.txt");
    text.write(in_words(r));
    text.commit();
    file::write_datapackage(
        folder_ / "datapackage.json", fmt::format("Mended: {}", r.request.scene->id),
        {{"mend.csv", "a form, the same with wider operations, or one of the catalogue", form_columns},
         {"minimal.csv", "an operation that is done wider", minimal_columns}});
}

std::string emitted(const MendResult& r, const std::filesystem::path& file, const std::string& command) {
    const auto& m = r.mended;
    const std::string own(r.request.row.form->info->name), stem = file.stem().string();
    if (!m.set || m.set->operations.empty())
        throw InputError(
            fmt::format("--emit {}: no operation of {} is wider, so there is no other form to write; {}", file.string(),
                        own, m.set ? "it meets the wish as it is" : "with all of them wider it fails the wish, too"));
    const std::string wider = name_of_wider(m.wider);
    FormWords words{
        .name = "mended." + stem,
        .title = fmt::format("{}, {} of its {} operations in {}", own, m.set->operations.size(), m.operations, wider),
        .source = command,
        .comment = fmt::format("// {} with {} of its {} operations in {}, the smallest set that was found for\n"
                               "// {} on every pixel of {}.\n// Made by {}\n",
                               own, m.set->operations.size(), m.operations, wider, choice::in_words(r.request.wish),
                               r.request.scene->id, command),
        .two_words = m.wider != binary64};
    return form_header(with_wider(m, m.set->operations), *r.request.row.form, words);
}

}  // namespace lostbits::output::mend
