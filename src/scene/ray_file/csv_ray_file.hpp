// Reads rays from CSV: a header, then one record on each line. Accepts RFC 4180 and the variants that other programs
// write.
#pragma once

#include "scene/ray_file/number_parser.hpp"
#include "scene/ray_file/ray_file.hpp"
#include "scene/toml/byte_source.hpp"

namespace lostbits::scene::ray_file {

/// Accepts commas, LF or CRLF, cells with or without quotes, spaces around numbers, and blank lines between records.
class CsvRayFile final : public RayFile {
public:
    CsvRayFile(const std::filesystem::path& path, const ReadOptions& options);

    [[nodiscard]] const Layout& layout() const override { return *layout_; }
    [[nodiscard]] std::uint64_t bytes() const override { return source_.size().value_or(0); }
    bool next(std::size_t max_records, Records& records) override;
    [[nodiscard]] Chunk decode(const Records& records) const override;

private:
    /// Returns the end of the record that begins at `begin` of the buffer, after its line break. Reads more of the file
    /// if necessary. Returns 0 at the end of the file.
    std::size_t find_record_end(std::size_t begin);
    void read_header(const ReadOptions& options);
    /// Names the columns of a file without a header, as `--columns` gives them.
    void name_columns(const std::string& names_text);
    void read_header_line();
    void decode_line(std::string_view line, std::uint64_t line_number, ChunkWriter& writer, Chunk& chunk) const;
    /// Stores the text of a cell in a slot as a number. Returns the reason if this is not possible.
    [[nodiscard]] std::optional<std::string> store_number(std::string_view text, std::size_t slot,
                                                          ChunkWriter& writer) const;
    [[nodiscard]] std::string position_text(std::uint64_t line, std::size_t column) const;

    toml::ByteSource source_;
    std::optional<Layout> layout_;
    std::optional<NumberParser> parser_;
    std::string buffer_;
    std::size_t used_bytes_ = 0;   ///< number of bytes of the buffer that were returned
    bool at_end_of_file_ = false;  ///< true if the buffer holds the last bytes of the file
    std::uint64_t line_ = 1, record_ = 0;
};

}  // namespace lostbits::scene::ray_file
