// A text file line by line, with its errors: of any size, a line at a time in memory.
#pragma once

#include <charconv>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "number/error.hpp"

namespace lostbits::scene::triangle {

class TextLines {
public:
    static constexpr std::size_t longest = 1 << 20;

    /// `bytes`: at the first of them.
    TextLines(const std::filesystem::path& path, std::istream& bytes, std::size_t line = 0)
        : path_(path), bytes_(bytes), number_(line), room_(longest + 1) {}

    /// The next line without its end; false after the last.
    bool next() {
        bytes_.getline(room_.data(), static_cast<std::streamsize>(room_.size()));
        if (bytes_.gcount() == 0 && !bytes_) return false;
        ++number_;
        if (bytes_.fail() && !bytes_.eof()) fail("is longer than 1 MB; a mesh has a vertex or a face a line");
        rest_ = std::string_view(room_.data());
        return true;
    }
    /// The next word of the line; empty at its end.
    std::string_view word() {
        const std::size_t begin = std::min(rest_.find_first_not_of(" \t\r"), rest_.size());
        const std::size_t end = std::min(rest_.find_first_of(" \t\r", begin), rest_.size());
        const std::string_view found = rest_.substr(begin, end - begin);
        rest_.remove_prefix(end);
        return found;
    }
    /// The next word as a number of type T, rounded once; `what` names it in errors.
    template <class T>
    T number(std::string_view what) {
        std::string_view text = word();
        if (text.empty()) fail("ends before " + std::string(what));
        const std::string shown(text.substr(0, 40));
        if (text.starts_with('+')) text.remove_prefix(1);
        T x{};
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
        if (error == std::errc::result_out_of_range) fail(std::string(what) + " is \"" + shown + "\", which overflows");
        if (error != std::errc() || end != text.data() + text.size())
            fail(std::string(what) + " is \"" + shown + "\", which is not a number");
        if constexpr (std::is_floating_point_v<T>)
            if (!std::isfinite(x)) fail(std::string(what) + " is \"" + shown + "\"; a vertex has finite numbers");
        return x;
    }

    [[nodiscard]] std::size_t line() const { return number_; }
    [[nodiscard]] std::string place() const { return path_.string() + ":" + std::to_string(number_); }
    [[noreturn]] void fail(const std::string& what) const { throw InputError(place() + ": " + what); }

private:
    const std::filesystem::path& path_;
    std::istream& bytes_;
    std::size_t number_;
    std::vector<char> room_;
    std::string_view rest_;
};

}  // namespace lostbits::scene::triangle
