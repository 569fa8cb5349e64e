// A row a ray: what the file has of it, and what became of it.
#pragma once

#include <filesystem>
#include <vector>

#include "measure/judge/judge.hpp"
#include "output/file/csv.hpp"

namespace lostbits::output::judge {

/// The CSV of one row of the work.
class RayRows {
public:
    /// `decides`: the row's answers have no t. Without a path there is no file: see `take_lines`.
    RayRows(const std::filesystem::path& path, const scene::dump::Dump& dump,
            const std::vector<const measure::metric::Metric*>& metrics, bool decides);
    static std::vector<file::Column> columns(const scene::dump::Dump& dump,
                                             const std::vector<const measure::metric::Metric*>& metrics);

    void add(const scene::dump::Chunk& chunk, const measure::map::BandResult& result, const measure::map::MapRow& row);
    /// What was added since the last call, where there is no file.
    [[nodiscard]] std::string take_lines() { return csv_.take_lines(); }
    void add_lines(const std::string& lines) { csv_.add_lines(lines); }
    void close() { csv_.close(); }

private:
    void add_given(const scene::dump::Chunk& chunk, std::size_t i);
    [[nodiscard]] file::Cell number(double x) const;

    const scene::dump::Dump& dump_;
    const std::vector<const measure::metric::Metric*>& metrics_;
    bool decides_;
    std::size_t kept_;  ///< columns of the file's own
    bool narrow_;       ///< its numbers are floats, and are written as short as floats are
    file::CsvWriter csv_;
};

}  // namespace lostbits::output::judge
