// What a call hands back: tables of columns, as the writers of CSV files have them, and texts.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "analysis/library/lostbits.h"
#include "measure/evaluate/evaluate.hpp"
#include "output/table/table.hpp"

namespace lostbits::analysis::library {

/// One column and its rows: of numbers, of texts or of categories, by its type and by whether it has names.
struct ResultColumn {
    output::file::Column about;
    std::vector<double> numbers = {};
    std::vector<std::optional<std::string>> texts = {};
    std::vector<std::uint8_t> codes = {};
    std::vector<std::string> names = {};  ///< of the codes

    std::vector<const char*> text_pointers = {}, name_pointers = {};  ///< made by `seal`
};

/// Rows that a CSV file would have, in memory.
class ResultTable {
public:
    ResultTable(std::string name, const std::vector<output::file::Column>& columns);
    /// Takes rows as a file does.
    [[nodiscard]] output::file::CsvWriter writer();
    /// The column of that name, which is there.
    [[nodiscard]] ResultColumn& operator[](const std::string& column);
    /// Makes the pointers that C reads; nothing is added after.
    void seal();

    std::string name;
    std::vector<ResultColumn> columns;
    [[nodiscard]] std::size_t rows() const;
};

/// A row a ray of one form and format, as a map or a judgement gives them band by band.
class RayTable final : public measure::evaluate::EvaluationSink {
public:
    RayTable(ResultTable& table, const measure::evaluate::TestedForm& row,
             const std::vector<const measure::metric::Metric*>& metrics);
    static std::vector<output::file::Column> columns(const std::vector<const measure::metric::Metric*>& metrics);
    void band(const measure::evaluate::BandResult& result) override;

private:
    ResultTable& table_;
    const measure::evaluate::TestedForm& row_;
    const std::vector<const measure::metric::Metric*>& metrics_;
};

}  // namespace lostbits::analysis::library

struct lostbits_result {
    std::deque<lostbits::analysis::library::ResultTable> tables;
    std::vector<std::string> texts;

    template <class R>
    void add_table(const char* name, const lostbits::output::table::Table<R>& table, const std::vector<R>& rows) {
        auto csv = tables.emplace_back(name, table.columns()).writer();
        for (const R& row : rows) table.add_row(csv, row);
    }
};
