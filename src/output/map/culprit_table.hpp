// How often each operation is the culprit: a row per form, format and operation.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "measure/map/map.hpp"
#include "output/file/csv.hpp"

namespace lostbits::output::map {

/// The culprits of summaries in a long table: as columns, operations would differ from run to run.
class CulpritTable {
public:
    /// Opens the file. `before` are columns in front, such as the axis of a sweep.
    CulpritTable(const std::filesystem::path& path, const std::vector<file::Column>& before,
                 const std::vector<const measure::metric::Metric*>& metrics);
    static std::vector<file::Column> columns(std::vector<file::Column> before);

    /// Only where `culprit` is among the metrics.
    [[nodiscard]] static bool is_wanted(const std::vector<const measure::metric::Metric*>& metrics);

    /// A row for each operation that is the culprit of any ray, the most frequent first; `put` writes the cells in
    /// front.
    void add(
        const measure::map::MapRow& row, const measure::map::MapSummary& summary,
        const std::function<void(file::CsvWriter&)>& put = [](file::CsvWriter&) {});
    void close() { csv_.close(); }

private:
    file::CsvWriter csv_;
    std::size_t place_;  ///< of `culprit` among the metrics
    std::span<const std::string_view> categories_;
};

/// The operations that are the culprit of any ray, by their categories, the most frequent first; of equals the first on
/// the tape.
std::vector<std::size_t> culprits_by_count(const std::vector<std::uint64_t>& counts);

}  // namespace lostbits::output::map
