// A row a ray: what the file has of it, and what became of it.
#pragma once

#include <filesystem>
#include <vector>

#include "measure/judge/judge.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::output::judge {

/// A ray of a chunk of the file.
struct JudgedRay {
    const scene::dump::Chunk* chunk;
    map::BandRay found;
};

/// The columns of one row of the work. `decides`: its answers have no t.
table::Table<JudgedRay> ray_table(const scene::dump::Dump& dump,
                                  const std::vector<const measure::metric::Metric*>& metrics, bool decides = false);

/// The CSV of one row of the work.
class RayRows {
public:
    /// Without a path there is no file: see `take_lines`.
    RayRows(const std::filesystem::path& path, table::Table<JudgedRay> table)
        : table_(std::move(table)),
          csv_(path.empty() ? file::CsvWriter(table_.columns()) : file::CsvWriter(path, table_.columns())) {}

    void add(const scene::dump::Chunk& chunk, const measure::evaluate::BandResult& result,
             const measure::evaluate::TestedForm& row) {
        for (std::size_t i = 0; i < chunk.size(); ++i) table_.add_row(csv_, {&chunk, {&result, i, &row}});
    }
    /// What was added since the last call, where there is no file.
    [[nodiscard]] std::string take_lines() { return csv_.take_lines(); }
    void add_lines(const std::string& lines) { csv_.add_lines(lines); }
    void close() { csv_.close(); }

private:
    table::Table<JudgedRay> table_;
    file::CsvWriter csv_;
};

}  // namespace lostbits::output::judge
