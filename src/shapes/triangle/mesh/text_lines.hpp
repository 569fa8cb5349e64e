// Reads a text file line by line, and reports errors with their position. Files may be of any size: one line at a time
// is in memory.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "number/real.hpp"
#include "scene/toml/parse_number.hpp"
#include "scene/toml/round.hpp"
#include "shapes/triangle/mesh/mesh_bytes.hpp"
#include "shapes/triangle/mesh/mesh_readers.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::scene::triangle {

/// How a statement of a text file ends: with its line, or with the first line that does not end with a backslash.
enum class StatementKind : std::uint8_t { line, continued_by_backslash };

class TextLines {
public:
    static constexpr std::size_t max_line_bytes = std::size_t{1} << 20;

    explicit TextLines(MeshBytes& bytes, StatementKind statement = StatementKind::line)
        : bytes_(bytes), statement_(statement) {}

    /// Goes to the next line, on which a new statement begins. Returns false after the last line. A byte order mark is
    /// not part of the first line.
    bool next() {
        if (!read_line()) return false;
        statement_line_ = line_number_;
        indent_ = std::min(line_.find_first_not_of(" \t"), line_.size());
        return true;
    }
    /// Goes to the line on which the statement continues. Returns false if it does not continue, or the file ends.
    bool next_continuation() { return std::exchange(continues_, false) && read_line(); }
    /// Returns the next word of the statement; empty at its end.
    std::string_view word() {
        while (true) {
            word_start_ = std::min(line_.find_first_not_of(" \t", word_end_), line_.size());
            word_end_ = std::min(line_.find_first_of(" \t", word_start_), line_.size());
            if (word_end_ > word_start_ || !continues_) return line_.substr(word_start_, word_end_ - word_start_);
            const std::string word_position = position();
            if (!next_continuation())
                throw InputError(word_position +
                                 ": continues on the next line, but the file ends here; was it cut short?");
        }
    }
    /// Reads the next word as a number of type T, rounded once. Errors call it `number_name`.
    template <class T>
    T number(std::string_view number_name) {
        const std::string_view text = word();
        if (text.empty()) fail("ends before " + std::string(number_name));
        const std::string_view digits = text.starts_with('+') ? text.substr(1) : text;
        T x{};
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
        const bool is_whole_word = end == digits.data() + digits.size();
        if (error == std::errc::result_out_of_range && is_whole_word) return out_of_range_number<T>(text, number_name);
        if (error != std::errc() || !is_whole_word || text.starts_with("+-"))
            fail(std::string(number_name) + " is " + text::quoted_excerpt(text) + ", which is not " +
                 (std::is_unsigned_v<T>   ? "a whole number of at least 0"
                  : std::is_integral_v<T> ? "a whole number"
                                          : "a number; write a decimal with a point, such as 0.5 or 1e-3"));
        return x;
    }
    /// Reads the next word as a coordinate of a vertex that the scene can hold.
    template <class T>
    T coordinate(std::string_view number_name, const FloatFormat& vertex_format) {
        const T x = number<T>(number_name);
        if (const auto fault = reason_to_refuse_coordinate(static_cast<double>(x), vertex_format); !fault.empty())
            fail(std::string(number_name) + " is " +
                 text::quoted_excerpt(line_.substr(word_start_, word_end_ - word_start_)) + ", which " +
                 std::string(fault));
        return x;
    }

    /// Returns the line on which the statement begins.
    [[nodiscard]] std::size_t line() const { return statement_line_; }
    /// Returns the position of the word that was read last. Columns count characters.
    [[nodiscard]] std::string position() const { return position_of_byte(word_start_); }
    [[noreturn]] void fail(const std::string& problem) const { throw InputError(position() + ": " + problem); }
    /// Throws InputError with the position of the statement.
    [[noreturn]] void fail_line(const std::string& problem) const {
        throw InputError(position_at(statement_line_, indent_ + 1) + ": " + problem);
    }

private:
    /// Reads the next line, without its line break and without a backslash that continues it.
    bool read_line() {
        if (!bytes_.take_line(line_, max_line_bytes)) return false;
        word_end_ = 0;
        word_start_ = 0;
        if (++line_number_ == 1 && line_.starts_with("\xEF\xBB\xBF")) line_.remove_prefix(3);
        if (line_.size() > max_line_bytes) fail("is longer than 1 MB; write one vertex or face on each line");
        if (line_.ends_with('\r')) line_.remove_suffix(1);
        // Some programs treat these bytes as the end of a line, and hide the rest of it.
        require_without_byte('\0', "has a zero byte; is it a text file?");
        require_without_byte('\r', "has a carriage return inside the line; end lines with line feeds");
        const std::size_t last_character = line_.find_last_not_of(" \t");
        continues_ = statement_ == StatementKind::continued_by_backslash && last_character < line_.size() &&
                     line_[last_character] == '\\';
        if (continues_) line_ = line_.substr(0, last_character);
        return true;
    }
    /// Rounds the exact number. A number that is too small for T rounds like any other; a number that is too large is
    /// an error.
    template <class T>
    T out_of_range_number(std::string_view text, std::string_view number_name) const {
        if constexpr (std::is_floating_point_v<T>) {
            const auto parsed = toml::parse_number(text);
            if (const Real* const exact = std::get_if<Real>(&parsed))
                if (const double x = toml::round_to_format(*exact, sizeof(T) == 4 ? binary32 : binary64);
                    std::isfinite(x))
                    return static_cast<T>(x);
        }
        fail(std::string(number_name) + " is " + text::quoted_excerpt(text) + ", which overflows");
    }
    void require_without_byte(char byte, const char* message) {
        const void* const found = std::memchr(line_.data(), byte, line_.size());
        if (found == nullptr) return;
        word_start_ = static_cast<std::size_t>(static_cast<const char*>(found) - line_.data());
        fail(message);
    }
    [[nodiscard]] std::string position_of_byte(std::size_t byte) const {
        // False for the other bytes of a character in UTF-8.
        const auto starts_character = [](char c) { return (c & 0xc0) != 0x80; };
        return position_at(
            line_number_, static_cast<std::size_t>(std::ranges::count_if(line_.substr(0, byte), starts_character)) + 1);
    }
    /// Line 1 in an empty file, which has no line.
    [[nodiscard]] std::string position_at(std::size_t line, std::size_t column) const {
        return bytes_.name() + ":" + std::to_string(std::max<std::size_t>(line, 1)) + ":" + std::to_string(column);
    }

    MeshBytes& bytes_;
    StatementKind statement_;
    bool continues_ = false;  ///< the statement continues on the next line
    std::size_t line_number_ = 0, statement_line_ = 0,
                indent_ = 0;  ///< current line, statement's first line, its indent
    std::string_view line_;
    std::size_t word_end_ = 0, word_start_ = 0;  ///< end and start of the last word in the line
};

}  // namespace lostbits::scene::triangle
