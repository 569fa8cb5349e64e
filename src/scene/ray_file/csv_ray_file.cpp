#include "scene/ray_file/csv_ray_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "number/error.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::scene::ray_file {

namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 20, longest_line = std::size_t{1} << 20;

std::string_view trim_blanks(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
    return text;
}

/// Reads the cells of one line, without their quotes. Stores the text of cells that have doubled quotes.
class CellReader {
public:
    explicit CellReader(std::string_view line) : rest_(line), line_(line.data()) {}

    /// Reads the next cell. Returns false after the last cell. `fault` is the error in the quotes of the cell, or null.
    bool next(std::string_view& cell, const char*& fault) {
        if (at_end_) return false;
        cell_start_ = static_cast<std::size_t>(rest_.data() - line_);
        fault = nullptr;
        const std::size_t blank_count = std::min(rest_.find_first_not_of(" \t"), rest_.size());
        if (blank_count < rest_.size() && rest_[blank_count] == '"') return next_quoted(blank_count, cell, fault);
        const std::size_t comma = std::min(rest_.find(','), rest_.size());
        cell = rest_.substr(0, comma);
        if (cell.find('"') != std::string_view::npos) fault = "a quote is inside a cell that does not begin with one";
        skip_past(comma);
        return true;
    }
    /// Position in the line, from 0, at which the cell begins that was read last.
    [[nodiscard]] std::size_t cell_start() const { return cell_start_; }

private:
    bool next_quoted(std::size_t blank_count, std::string_view& cell, const char*& fault) {
        text_.clear();
        std::size_t position = blank_count + 1;
        for (;; ++position) {
            if (position >= rest_.size()) {
                fault = "a quote opens a cell and does not close it";
                break;
            }
            if (rest_[position] != '"') text_ += rest_[position];
            else if (position + 1 < rest_.size() && rest_[position + 1] == '"') text_ += rest_[position++];
            else break;
        }
        const std::size_t comma = std::min(rest_.find(',', std::min(position, rest_.size())), rest_.size());
        if (fault == nullptr && !trim_blanks(rest_.substr(position + 1, comma - position - 1)).empty())
            fault = "text follows the quote that closes a cell";
        cell = text_;
        skip_past(comma);
        return true;
    }
    /// Goes on behind the comma, or to the end of the line if there is no comma.
    void skip_past(std::size_t comma) {
        at_end_ = comma == rest_.size();
        rest_.remove_prefix(at_end_ ? comma : comma + 1);
    }

    std::string_view rest_;
    const char* line_;
    std::string text_;
    std::size_t cell_start_ = 0;
    bool at_end_ = false;
};

bool is_blank(std::string_view line) { return line.find_first_not_of(" \t") == std::string_view::npos; }

/// Returns a line without its line break.
std::string_view trim_line_break(std::string_view text) {
    if (text.ends_with('\n')) text.remove_suffix(1);
    if (text.ends_with('\r')) text.remove_suffix(1);
    return text;
}

}  // namespace

CsvRayFile::CsvRayFile(const std::filesystem::path& path, const ReadOptions& options)
    : RayFile(path), source_(path, options.stop) {
    read_header(options);
    finish_header(options, *layout_, *find_format("f64"));
    parser_.emplace(settings().format);
}

std::string CsvRayFile::position_text(std::uint64_t line, std::size_t column) const {
    return fmt::format("{}:{}:{}", source_.name(), line, column + 1);
}

std::size_t CsvRayFile::find_record_end(std::size_t begin) {
    std::size_t counted_end = begin;  // the quotes before this position are counted
    bool is_in_quotes = false;
    for (;;) {
        // Goes to the next line break, or to the end of the buffer. A line break in quotes belongs to a cell.
        const auto* const line_break =
            static_cast<const char*>(std::memchr(buffer_.data() + counted_end, '\n', buffer_.size() - counted_end));
        const std::size_t stop = line_break ? static_cast<std::size_t>(line_break - buffer_.data()) : buffer_.size();
        if (std::memchr(buffer_.data() + counted_end, '"', stop - counted_end) != nullptr)
            is_in_quotes ^= (std::count(buffer_.begin() + static_cast<std::ptrdiff_t>(counted_end),
                                        buffer_.begin() + static_cast<std::ptrdiff_t>(stop), '"') &
                             1) != 0;

        counted_end = line_break ? stop + 1 : stop;
        if (line_break && !is_in_quotes) return counted_end;

        if (counted_end - begin > longest_line)
            throw InputError(position_text(line_, 0) +
                             ": is longer than a million characters; is this a CSV file? Raw numbers "
                             "are read with --columns");

        if (line_break) continue;
        if (at_end_of_file_) return counted_end > begin ? counted_end : 0;
        at_end_of_file_ = source_.read(buffer_, block_bytes) < block_bytes;
    }
}

void CsvRayFile::read_header(const ReadOptions& options) {
    if (source_.read(buffer_, block_bytes) < block_bytes) at_end_of_file_ = true;
    if (buffer_.starts_with("\xEF\xBB\xBF")) used_bytes_ = 3;
    if (options.columns.empty()) read_header_line();
    else name_columns(options.columns);
}

void CsvRayFile::name_columns(const std::string& names_text) {
    std::vector<std::string> names;
    CellReader cells(names_text);
    const char* fault = nullptr;
    for (std::string_view cell; cells.next(cell, fault);) names.emplace_back(trim_blanks(cell));
    layout_.emplace(std::move(names),
                    [](std::size_t, const std::string& why) { throw InputError("--columns: " + why); });
}

void CsvRayFile::read_header_line() {
    // Finds the first line that is not blank.
    std::string_view line;
    std::size_t end = used_bytes_;
    do {
        const std::size_t begin = end;
        end = find_record_end(begin);
        if (end == 0)
            throw InputError(source_.name() + ":1:1: is empty; a CSV of rays begins with the names of its columns");
        line = trim_line_break(std::string_view(buffer_).substr(begin, end - begin));
        line_ += static_cast<std::uint64_t>(std::ranges::count(buffer_.substr(begin, end - begin), '\n'));
    } while (is_blank(line));
    const std::uint64_t header = line_ - (buffer_[end - 1] == '\n' ? 1 : 0);

    // Reads the names in its cells.
    std::vector<std::string> names;
    std::vector<std::size_t> cell_starts;
    CellReader cells(line);
    const char* fault = nullptr;
    for (std::string_view cell; cells.next(cell, fault);) {
        if (fault != nullptr)
            throw InputError(position_text(header, cells.cell_start()) + ": " + fault + "; write \"\" for a quote");
        names.emplace_back(trim_blanks(cell));
        cell_starts.push_back(cells.cell_start());
    }

    // Rejects a line that is not a header: one with another separator, or a record.
    if (names.size() == 1 && line.find_first_of(";\t") != std::string_view::npos)
        throw InputError(position_text(header, line.find_first_of(";\t")) +
                         ": the columns are not separated by commas; write commas between them");
    const std::string first = names.front();
    if (NumberParser(*find_format("f64")).read(first).kind != NumberParser::Kind::not_numeric)
        throw InputError(position_text(header, 0) + ": \"" + first +
                         "\" is a number, but the names of the columns are expected here; name them with --columns "
                         "ox,oy,oz,dx,dy,dz,… if the file has no header");

    layout_.emplace(std::move(names), [&](std::size_t c, const std::string& why) {
        throw InputError(position_text(header, cell_starts[c]) + ": " + why);
    });
    used_bytes_ = end;
}

bool CsvRayFile::next(std::size_t max_records, Records& records) {
    records.first = record_;
    records.count = 0;
    buffer_.erase(0, used_bytes_);
    used_bytes_ = 0;
    records.line = line_;
    std::size_t end = 0;
    while (records.count < max_records) {
        const std::size_t record_end = find_record_end(end);
        if (record_end == 0) break;
        const std::string_view line(buffer_.data() + end, record_end - end);
        if (!is_blank(trim_line_break(line))) ++records.count;
        // Also counts the line breaks in quoted cells.
        line_ += 1;
        if (line.find('"') != std::string_view::npos)
            line_ += static_cast<std::uint64_t>(std::ranges::count(trim_line_break(line), '\n'));
        end = record_end;
    }
    record_ += records.count;
    records.bytes.assign(buffer_, 0, end);
    used_bytes_ = end;
    return records.count > 0;
}

Chunk CsvRayFile::decode(const Records& records) const {
    Chunk chunk;
    chunk.first = records.first;
    ChunkWriter writer(*layout_, settings(), records.count, chunk);
    std::string_view rest = records.bytes;
    std::uint64_t line_number = records.line;
    while (!rest.empty()) {
        std::size_t end = 0, quotes = 0;
        do {  // a line break inside quotes belongs to the cell
            const std::size_t begin = end;
            end = std::min(rest.find('\n', begin), rest.size() - 1) + 1;
            quotes += static_cast<std::size_t>(std::ranges::count(rest.substr(begin, end - begin), '"'));
        } while (end < rest.size() && quotes % 2 != 0);
        const std::string_view line = trim_line_break(rest.substr(0, end));
        if (!is_blank(line)) decode_line(line, line_number, writer, chunk);
        line_number += 1 + static_cast<std::uint64_t>(std::ranges::count(line, '\n'));
        rest.remove_prefix(end);
    }
    return chunk;
}

std::optional<std::string> CsvRayFile::store_number(std::string_view text, std::size_t slot,
                                                    ChunkWriter& writer) const {
    if (text.empty()) return std::nullopt;
    const NumberParser::ParsedNumber parsed = parser_->read(text);
    switch (parsed.kind) {
        case NumberParser::Kind::number:
            writer.put(slot, parsed.value, parsed.is_representable, parsed.digits);
            return std::nullopt;
        case NumberParser::Kind::too_large:
            return fmt::format(
                "is larger than the largest number of {}; name the format that the answers were computed "
                "in with --answer-format",
                format().name);
        case NumberParser::Kind::not_numeric: break;
    }

    // Only decisions may be words.
    const bool is_boolean = slot == slot::hit || slot == slot::parity || slot == slot::inside;
    if (is_boolean && (text == "true" || text == "True" || text == "TRUE")) writer.put(slot, 1, true);
    else if (is_boolean && (text == "false" || text == "False" || text == "FALSE")) writer.put(slot, 0, true);
    else if (is_boolean) return "is neither true nor false; write 1, 0, true or false";
    else
        return "is not a number; write a decimal such as 4100 or 1e-3, a hexadecimal float such as 0x1.004p+12, nan or "
               "inf";
    return std::nullopt;
}

void CsvRayFile::decode_line(std::string_view line, std::uint64_t line_number, ChunkWriter& writer,
                             Chunk& chunk) const {
    const auto& columns = layout_->columns();
    std::size_t starts_by_slot[slot::count] = {};
    CellReader cells(line);
    const char* fault = nullptr;

    std::size_t c = 0;
    for (std::string_view cell; cells.next(cell, fault); ++c) {
        if (fault != nullptr)
            throw InputError(position_text(line_number, cells.cell_start()) + ": " + fault +
                             "; write \"\" for a quote");

        // A cell is stored as a number if its column has a meaning, and as text if it is one of the user's own.
        if (c >= columns.size()) continue;
        if (columns[c].slot) {
            starts_by_slot[*columns[c].slot] = cells.cell_start();
            const std::string_view text = trim_blanks(cell);
            if (const auto why_not = store_number(text, *columns[c].slot, writer))
                throw InputError(fmt::format("{}: {} \"{}\" {}", position_text(line_number, cells.cell_start()),
                                             columns[c].name, text, *why_not));
        }
        if (!columns[c].slot && !columns[c].is_skipped && settings().keeps_own_columns) chunk.kept.emplace_back(cell);
    }

    if (c != columns.size())
        throw InputError(fmt::format("{}: has {}, but the header has {}; leave a cell empty if it has no value{}",
                                     position_text(line_number, 0), text::count_with_noun(c, "cell"),
                                     text::count_with_noun(columns.size(), "column"),
                                     c < columns.size() ? " (or the file is cut short)" : ""));

    writer.end_record([&](std::size_t s) { return position_text(line_number, starts_by_slot[s]); });
}

}  // namespace lostbits::scene::ray_file
