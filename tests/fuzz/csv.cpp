#include "fuzz/fuzz.hpp"
#include "output/file/read_csv.hpp"

namespace lostbits::fuzz {

/// A table, every cell of it read as a value, and each value equal to itself.
void fuzz_csv(std::string_view bytes) {
    answer_or_error([&] {
        const output::file::CsvTable table = output::file::parse_csv(std::string(bytes), "input.csv");
        for (const auto& column : table.columns) {
            for (const std::string_view cell : column.cells) {
                const output::file::CellValue value = output::file::read_cell(cell);
                if (value.kind != output::file::CellValue::Kind::number) continue;
                static_cast<void>(value.approximate());
                if (!(value == value)) throw std::logic_error("a number differs from itself");
            }
        }
    });
}

}  // namespace lostbits::fuzz
