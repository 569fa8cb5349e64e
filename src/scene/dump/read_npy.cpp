#include <fmt/format.h>

#include <charconv>
#include <limits>

#include "number/error.hpp"
#include "scene/dump/binary_dump.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::scene::dump {

namespace {

/// The dictionary in front of an array, in Python's notation.
struct NpyHeader {
    struct Field {
        std::string name;  ///< empty if the array has no fields
        std::string type;
        std::vector<std::uint64_t> shape = {};  ///< of a field that is an array itself
    };
    std::vector<Field> fields;
    bool fortran = false;
    std::vector<std::uint64_t> shape;
    bool structured = false;
};

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
        if (end == std::string_view::npos) fail("a string is not closed");
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
    /// Reads a number, or numbers in parentheses.
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
            if (is('(')) fail("a field has a title beside its name, which is not supported");
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

/// Reads a header. Throws InputError that begins with `where` for anything else.
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

constexpr std::string_view magic = "\x93NUMPY";

/// Returns the dictionary, and the position where the numbers begin.
std::pair<std::string, std::uint64_t> header_text(toml::ByteSource& source) {
    const auto cut_short = [&]() { throw InputError(source.name() + ": ends inside its header; it was cut short"); };
    std::string start;
    source.read(start, 8);
    if (!start.starts_with(magic))
        throw InputError(source.name() +
                         ": is not an array of numpy (it does not begin with \\x93NUMPY); write it with "
                         "numpy.save, or say --container csv or raw");
    if (start.size() < 8) cut_short();
    const int version = start[6];
    if (version < 1 || version > 3)
        throw InputError(fmt::format("{}: is an array file of version {}; only versions 1 to 3 are supported",
                                     source.name(), version));
    const std::size_t wide = version == 1 ? 2 : 4;
    std::string length;
    if (source.read(length, wide) < wide) cut_short();
    std::size_t size = 0;
    for (std::size_t i = 0; i < wide; ++i) size |= std::size_t{static_cast<unsigned char>(length[i])} << 8 * i;
    if (size > std::size_t{1} << 20) throw InputError(source.name() + ": its header is longer than a million bytes");
    std::string text;
    if (source.read(text, size) < size) cut_short();
    return {text, 8 + wide + size};
}

std::uint64_t product(const std::vector<std::uint64_t>& numbers) {
    std::uint64_t all = 1;
    for (const std::uint64_t n : numbers)
        all = n != 0 && all > (std::uint64_t{1} << 48) / n ? std::uint64_t{1} << 48 : all * n;
    return all;
}

ItemType type_of(const std::string& word, const std::string& name, const std::string& file) {
    const auto type = find_item_type(word);
    if (type && std::string_view("<>|=").find(word.front()) != std::string_view::npos) return *type;
    throw InputError(
        fmt::format("{}: {}is of type '{}'; only floats of 2, 4 or 8 bytes, integers and booleans are supported; "
                    "convert it with astype('<f4') or astype('<f8')",
                    file, name.empty() ? "" : "field '" + name + "' ", word));
}

constexpr std::uint64_t most_record_bytes = std::uint64_t{1} << 20;

/// Adds a field. If it is an array, it becomes several columns: those that its name stands for, or `name_0` and so on.
void add_field(const NpyHeader::Field& field, const std::string& file, std::uint64_t& offset,
               std::vector<BinaryColumn>& columns) {
    const auto pass = [&](std::uint64_t size, std::uint64_t times) {
        if (size > most_record_bytes || times > most_record_bytes || size * times > most_record_bytes - offset)
            throw InputError(fmt::format("{}: its records have more than {} bytes; write only the numbers of rays",
                                         file, most_record_bytes));
        offset += size * times;
    };
    // Bytes between fields, which numpy writes as fields without a name.
    if (const bool padding = field.type.starts_with("|V"); padding) {
        const std::uint64_t each = std::strtoull(field.type.c_str() + 2, nullptr, 10), times = product(field.shape);
        return pass(each, times);
    }
    const ItemType type = type_of(field.type, field.name, file);
    const std::uint64_t count = product(field.shape);
    if (count > 4096)
        throw InputError(
            fmt::format("{}: field '{}' has {} numbers; at most 4096 are supported", file, field.name, count));
    const std::uint64_t begin = offset;
    pass(type.size, count);
    const auto parts = parts_of(field.name, static_cast<std::size_t>(count));
    for (std::uint64_t k = 0; k < count; ++k) {
        const std::string name = field.shape.empty() ? field.name
                                 : parts.empty()     ? fmt::format("{}_{}", field.name, k)
                                                     : parts[static_cast<std::size_t>(k)];
        columns.push_back({name, type, begin + k * type.size});
    }
}

/// Returns the names of the last axis.
std::vector<std::string> names_in(const std::string& columns) {
    std::vector<std::string> names{""};
    for (const char c : columns) {
        if (c == ',') names.emplace_back();
        else if (c != ' ') names.back() += c;
    }
    return names;
}

}  // namespace

RecordLayout read_npy(toml::ByteSource& source, const DumpOptions& options) {
    const auto [text, begin] = header_text(source);
    const std::string& file = source.name();
    const NpyHeader header = read_npy_header(text, file);
    std::vector<std::uint64_t> rays = header.shape;
    RecordLayout array{.columns = {}, .begin = begin, .error_source = file};
    if (header.structured) {
        if (!options.columns.empty())
            throw InputError(file +
                             ": --columns names the columns of arrays without names; this one has fields with "
                             "names; leave --columns out");
        for (const NpyHeader::Field& field : header.fields) add_field(field, file, array.record_size, array.columns);
    } else {
        const ItemType type = type_of(header.fields.front().type, "", file);
        if (rays.size() < 2)
            throw InputError(
                fmt::format("{}: has {}; rays are an array of n rows and k columns, or of records with named fields",
                            file, toml::counted(rays.size(), "axis", "axes")));
        if (options.columns.empty())
            throw InputError(fmt::format("{}: has {} without names; name them with --columns ox,oy,oz,dx,dy,dz,…", file,
                                         toml::counted(rays.back(), "column")));
        const auto names = names_in(options.columns);
        if (names.size() != rays.back())
            throw InputError(fmt::format("{}: has {}, but --columns names {}; write _ for each column to skip", file,
                                         toml::counted(rays.back(), "column"), names.size()));
        rays.pop_back();
        for (const std::string& name : names) array.columns.push_back({name, type, 0});
    }
    array.records = product(rays);
    if (header.fortran && header.structured && rays.size() > 1) {
        throw InputError(file + ": is in Fortran order; write numpy.ascontiguousarray(a)");
    }
    if (header.fortran && rays.size() > 1)
        throw InputError(file + ": has more than two axes in Fortran order; write numpy.ascontiguousarray(a)");
    array.column_major = header.fortran && !header.structured;
    for (std::size_t c = 0; !header.structured && c < array.columns.size(); ++c) {
        const std::uint64_t size = array.columns[c].type.size;
        array.columns[c].offset = array.column_major ? c * *array.records * size : c * size;
        array.record_size += size;
    }
    if (array.record_size == 0) throw InputError(file + ": its records are empty");
    if (array.column_major && !source.size())
        throw InputError(file +
                         ": is in Fortran order, which cannot be read from a pipe; write numpy.ascontiguousarray(a)");
    constexpr auto most = static_cast<std::uint64_t>(std::numeric_limits<int>::max());
    if (rays.size() == 2 && rays[0] > 0 && rays[1] > 0 && rays[0] <= most && rays[1] <= most)
        array.picture = {static_cast<int>(rays[1]), static_cast<int>(rays[0])};
    return array;
}

}  // namespace lostbits::scene::dump
