// The header of an array of numpy: a dictionary as Python writes it.
#include <fmt/format.h>

#include <charconv>

#include "number/error.hpp"
#include "scene/dump/npy_dump.hpp"

namespace lostbits::scene::dump {

namespace {

class Literal {
public:
    Literal(std::string_view text, const std::string& where) : text_(text), where_(where) {}

    [[noreturn]] void fail(const std::string& why) const {
        throw InputError(
            fmt::format("{}: byte {} of the header: {}; write the file again with numpy.save", where_, at_, why));
    }
    bool take(char c) {
        skip();
        if (at_ >= text_.size() || text_[at_] != c) return false;
        ++at_;
        return true;
    }
    void require(char c) {
        if (!take(c)) fail(fmt::format("'{}' is expected", c));
    }
    [[nodiscard]] bool is(char c) {
        skip();
        return at_ < text_.size() && text_[at_] == c;
    }
    std::string string() {
        skip();
        if (at_ >= text_.size() || (text_[at_] != '\'' && text_[at_] != '"')) fail("a string is expected");
        const char quote = text_[at_++];
        const std::size_t end = text_.find(quote, at_);
        if (end == std::string_view::npos) fail("a string never closes");
        const std::string found(text_.substr(at_, end - at_));
        at_ = end + 1;
        return found;
    }
    bool boolean() {
        skip();
        for (const auto& [word, value] : {std::pair<std::string_view, bool>{"True", true}, {"False", false}}) {
            if (!text_.substr(at_).starts_with(word)) continue;
            at_ += word.size();
            return value;
        }
        fail("True or False is expected");
    }
    /// A number, or numbers in parentheses.
    std::vector<std::uint64_t> shape() {
        std::vector<std::uint64_t> all;
        if (!is('(')) return {number()};
        require('(');
        while (!take(')')) {
            all.push_back(number());
            if (!take(',') && !is(')')) fail("')' is expected");
        }
        return all;
    }
    std::vector<NpyHeader::Field> fields() {
        std::vector<NpyHeader::Field> all;
        require('[');
        while (!take(']')) {
            NpyHeader::Field& field = all.emplace_back();
            require('(');
            if (is('(')) fail("a field has a title beside its name, which we do not read");
            field.name = string();
            require(',');
            if (is('['))
                fail("field '" + field.name + "' is a record itself; write its numbers as fields of the array");
            field.type = string();
            if (take(',') && !is(')')) field.shape = shape();
            static_cast<void>(take(','));
            require(')');
            if (!take(',') && !is(']')) fail("']' is expected");
        }
        return all;
    }

private:
    void skip() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t')) ++at_;
    }
    std::uint64_t number() {
        skip();
        std::uint64_t n = 0;
        const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), n);
        if (error != std::errc{}) fail("a whole number is expected");
        at_ = static_cast<std::size_t>(end - text_.data());
        if (n > std::uint64_t{1} << 48) fail("an axis is longer than any file");
        return n;
    }

    std::string_view text_;
    const std::string& where_;
    std::size_t at_ = 0;
};

}  // namespace

NpyHeader read_npy_header(std::string_view text, const std::string& where) {
    Literal in(text, where);
    NpyHeader header;
    bool descr = false, order = false, shape = false;
    in.require('{');
    while (!in.take('}')) {
        const std::string key = in.string();
        in.require(':');
        if (key == "descr") {
            descr = true;
            header.structured = in.is('[');
            if (header.structured) {
                header.fields = in.fields();
            } else {
                header.fields.resize(1);
                header.fields.front().type = in.string();
            }
        } else if (key == "fortran_order") {
            order = true;
            header.fortran = in.boolean();
        } else if (key == "shape") {
            shape = true;
            header.shape = in.shape();
        } else {
            in.fail("'" + key + "' is not a key of such a header");
        }
        if (!in.take(',') && !in.is('}')) in.fail("'}' is expected");
    }
    if (!descr || !order || !shape) in.fail("descr, fortran_order or shape is missing");
    return header;
}

}  // namespace lostbits::scene::dump
