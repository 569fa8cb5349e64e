#include <fmt/format.h>

#include <charconv>
#include <limits>

#include "number/error.hpp"
#include "scene/ray_file/binary_ray_file.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::scene::ray_file {

namespace {

/// Header of an array: a dictionary in Python's notation.
struct NpyHeader {
    struct Field {
        std::string name;  ///< empty if the array has no fields
        std::string type;
        std::vector<std::uint64_t> shape = {};  ///< axes of a field that is itself an array
    };
    std::vector<Field> fields;
    bool is_fortran_order = false;
    std::vector<std::uint64_t> shape;
    bool is_structured = false;
};

/// Reads literals of Python: strings, truth values, numbers, and tuples of them.
class LiteralParser {
public:
    LiteralParser(std::string_view text, const std::string& error_start) : text_(text), error_start_(error_start) {}

    [[noreturn]] void fail(const std::string& why) const {
        throw InputError(fmt::format("{}: byte {} of the header: {}; write the file again with numpy.save",
                                     error_start_, position_, why));
    }
    bool skip_if(char c) {
        skip_blanks();
        if (position_ >= text_.size() || text_[position_] != c) return false;
        ++position_;
        return true;
    }
    void require(char c) {
        if (!skip_if(c)) fail(fmt::format("\"{}\" is expected", c));
    }
    [[nodiscard]] bool next_is(char c) {
        skip_blanks();
        return position_ < text_.size() && text_[position_] == c;
    }
    std::string string() {
        skip_blanks();
        if (position_ >= text_.size() || (text_[position_] != '\'' && text_[position_] != '"'))
            fail("a string is expected");
        const char quote = text_[position_++];
        const std::size_t end = text_.find(quote, position_);
        if (end == std::string_view::npos) fail("a string is not closed");
        const std::string contents(text_.substr(position_, end - position_));
        position_ = end + 1;
        return contents;
    }
    bool boolean() {
        skip_blanks();
        for (const auto& [literal, value] : {std::pair<std::string_view, bool>{"True", true}, {"False", false}}) {
            if (!text_.substr(position_).starts_with(literal)) continue;
            position_ += literal.size();
            return value;
        }
        fail("True or False is expected");
    }
    /// Reads a number, or numbers in parentheses.
    std::vector<std::uint64_t> shape() {
        std::vector<std::uint64_t> values;
        if (!next_is('(')) return {number()};
        require('(');
        while (!skip_if(')')) {
            values.push_back(number());
            if (!skip_if(',') && !next_is(')')) fail("\")\" is expected");
        }
        return values;
    }
    std::vector<NpyHeader::Field> fields() {
        std::vector<NpyHeader::Field> values;
        require('[');
        while (!skip_if(']')) {
            NpyHeader::Field& field = values.emplace_back();
            require('(');
            if (next_is('(')) fail("a field has a title besides its name, which is not supported");
            field.name = string();
            require(',');
            if (next_is('['))
                fail("field \"" + field.name + "\" is a record itself; write its numbers as fields of the array");
            field.type = string();
            if (skip_if(',') && !next_is(')')) field.shape = shape();
            static_cast<void>(skip_if(','));
            require(')');
            if (!skip_if(',') && !next_is(']')) fail("\"]\" is expected");
        }
        return values;
    }

private:
    void skip_blanks() {
        while (position_ < text_.size() &&
               (text_[position_] == ' ' || text_[position_] == '\n' || text_[position_] == '\t'))
            ++position_;
    }
    std::uint64_t number() {
        skip_blanks();
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(text_.data() + position_, text_.data() + text_.size(), value);
        if (error != std::errc{}) fail("a whole number is expected");
        position_ = static_cast<std::size_t>(end - text_.data());
        if (value > std::uint64_t{1} << 48) fail("an axis is longer than any file");
        return value;
    }

    std::string_view text_;
    const std::string& error_start_;
    std::size_t position_ = 0;
};

/// Reads a header. Throws InputError that begins with `error_start` for anything else.
NpyHeader read_npy_header(std::string_view text, const std::string& error_start) {
    LiteralParser parser(text, error_start);
    NpyHeader header;
    bool has_descr = false, has_order = false, has_shape = false;
    parser.require('{');
    while (!parser.skip_if('}')) {
        const std::string key = parser.string();
        parser.require(':');

        // A plain array has a single type, which becomes a field without a name.
        if (key == "descr") {
            has_descr = true;
            header.is_structured = parser.next_is('[');
            if (header.is_structured) {
                header.fields = parser.fields();
            } else {
                header.fields.resize(1);
                header.fields.front().type = parser.string();
            }
        } else if (key == "fortran_order") {
            has_order = true;
            header.is_fortran_order = parser.boolean();
        } else if (key == "shape") {
            has_shape = true;
            header.shape = parser.shape();
        } else {
            parser.fail("\"" + key + "\" is not a key of such a header");
        }

        // The last entry may end with a comma, as numpy writes it.
        if (!parser.skip_if(',') && !parser.next_is('}')) parser.fail("\"}\" is expected");
    }
    if (!has_descr || !has_order || !has_shape) parser.fail("descr, fortran_order or shape is missing");
    return header;
}

constexpr std::string_view magic = "\x93NUMPY";

/// Returns the dictionary, and the position where the numbers begin.
std::pair<std::string, std::uint64_t> read_header_text(toml::ByteSource& source) {
    const auto fail_cut_short = [&]() {
        throw InputError(source.name() + ": ends inside its header; it was cut short");
    };

    // The file begins with the magic text and two bytes of a version.
    std::string magic_and_version;
    source.read(magic_and_version, 8);
    if (!magic_and_version.starts_with(magic))
        throw InputError(source.name() +
                         ": is not an array of numpy (it does not begin with \\x93NUMPY); write it with "
                         "numpy.save, or say --container csv or raw");
    if (magic_and_version.size() < 8) fail_cut_short();
    const int version = magic_and_version[6];
    if (version < 1 || version > 3)
        throw InputError(fmt::format("{}: is an array file of version {}; only versions 1 to 3 are supported",
                                     source.name(), version));

    // The length of the dictionary follows, least significant byte first; version 1 has two bytes for it.
    const std::size_t length_bytes = version == 1 ? 2 : 4;
    std::string length_text;
    if (source.read(length_text, length_bytes) < length_bytes) fail_cut_short();
    std::size_t size = 0;
    for (std::size_t i = 0; i < length_bytes; ++i)
        size |= std::size_t{static_cast<unsigned char>(length_text[i])} << 8 * i;
    if (size > std::size_t{1} << 20) throw InputError(source.name() + ": its header is longer than a million bytes");

    std::string text;
    if (source.read(text, size) < size) fail_cut_short();
    return {text, 8 + length_bytes + size};
}

std::uint64_t product(const std::vector<std::uint64_t>& numbers) {
    std::uint64_t result = 1;
    for (const std::uint64_t factor : numbers)
        result = factor != 0 && result > (std::uint64_t{1} << 48) / factor ? std::uint64_t{1} << 48 : result * factor;
    return result;
}

ItemType parse_item_type(const std::string& type_name, const std::string& name, const std::string& file) {
    const auto type = find_item_type(type_name);
    if (type && std::string_view("<>|=").find(type_name.front()) != std::string_view::npos) return *type;
    throw InputError(
        fmt::format("{}: {}is of type \"{}\"; only floats of 2, 4 or 8 bytes, integers and booleans are supported; "
                    "convert it with astype('<f4') or astype('<f8')",
                    file, name.empty() ? "" : "field \"" + name + "\" ", type_name));
}

constexpr std::uint64_t max_record_bytes = std::uint64_t{1} << 20;

/// Adds a field. A field that is an array becomes several columns: those that its name stands for, or `name_0` and so
/// on.
void add_field(const NpyHeader::Field& field, const std::string& file, std::uint64_t& offset,
               std::vector<BinaryColumn>& columns) {
    const auto advance_offset = [&](std::uint64_t size, std::uint64_t repeat_count) {
        if (size > max_record_bytes || repeat_count > max_record_bytes ||
            size * repeat_count > max_record_bytes - offset)
            throw InputError(fmt::format("{}: its records have more than {} bytes; write only the numbers of rays",
                                         file, max_record_bytes));
        offset += size * repeat_count;
    };
    // Skips bytes between fields, which numpy writes as fields without a name.
    if (const bool is_padding = field.type.starts_with("|V"); is_padding) {
        const std::uint64_t padding_size = std::strtoull(field.type.c_str() + 2, nullptr, 10),
                            repeats = product(field.shape);
        return advance_offset(padding_size, repeats);
    }

    const ItemType type = parse_item_type(field.type, field.name, file);
    const std::uint64_t count = product(field.shape);
    if (count > 4096)
        throw InputError(
            fmt::format("{}: field \"{}\" has {} numbers; at most 4096 are supported", file, field.name, count));
    const std::uint64_t begin = offset;
    advance_offset(type.size, count);

    // Adds a column for each number of the field.
    const auto parts = columns_of_name(field.name, static_cast<std::size_t>(count));
    for (std::uint64_t k = 0; k < count; ++k) {
        const std::string name = field.shape.empty() ? field.name
                                 : parts.empty()     ? fmt::format("{}_{}", field.name, k)
                                                     : parts[k];
        columns.push_back({name, type, begin + k * type.size});
    }
}

/// Returns the names in a list of columns, `ox,oy,oz`.
std::vector<std::string> split_column_names(const std::string& columns) {
    std::vector<std::string> names{""};
    for (const char c : columns) {
        if (c == ',') names.emplace_back();
        else if (c != ' ') names.back() += c;
    }
    return names;
}

/// Sets the columns, the number of records and their size, for records with named fields. All axes are rays.
void read_structured_layout(const NpyHeader& header, const ReadOptions& options, const std::string& file,
                            RecordLayout& array) {
    if (!options.columns.empty())
        throw InputError(file +
                         ": --columns names the columns of arrays without names; this one has fields with "
                         "names; leave --columns out");
    for (const NpyHeader::Field& field : header.fields) add_field(field, file, array.record_size, array.columns);
    array.record_count = product(header.shape);

    // The order of the axes matters only if there are several.
    if (header.is_fortran_order && header.shape.size() > 1)
        throw InputError(file + ": is in Fortran order; write numpy.ascontiguousarray(a)");
}

/// Does the same for a plain array. Its last axis is the columns; `ray_axes` are the axes before it.
void read_plain_layout(const NpyHeader& header, const ReadOptions& options, const std::string& file,
                       std::vector<std::uint64_t>& ray_axes, RecordLayout& array) {
    const ItemType type = parse_item_type(header.fields.front().type, "", file);
    if (ray_axes.size() < 2)
        throw InputError(
            fmt::format("{}: has {}; rays are an array of n rows and k columns, or of records with named fields", file,
                        text::count_with_noun(ray_axes.size(), "axis", "axes")));

    // The command line gives one name for each column.
    if (options.columns.empty())
        throw InputError(fmt::format("{}: has {} without names; name them with --columns ox,oy,oz,dx,dy,dz,…", file,
                                     text::count_with_noun(ray_axes.back(), "column")));
    const auto names = split_column_names(options.columns);
    if (names.size() != ray_axes.back())
        throw InputError(fmt::format("{}: has {}, but --columns names {}; write _ for each column to skip", file,
                                     text::count_with_noun(ray_axes.back(), "column"), names.size()));
    ray_axes.pop_back();
    for (const std::string& name : names) array.columns.push_back({name, type, 0});
    array.record_count = product(ray_axes);

    // In Fortran order the columns follow one another, each with the numbers of all rays.
    if (header.is_fortran_order && ray_axes.size() > 1)
        throw InputError(file + ": has more than two axes in Fortran order; write numpy.ascontiguousarray(a)");
    array.is_column_major = header.is_fortran_order;
    for (std::size_t c = 0; c < array.columns.size(); ++c) {
        const std::uint64_t size = array.columns[c].type.size;
        array.columns[c].offset = array.is_column_major ? c * *array.record_count * size : c * size;
        array.record_size += size;
    }
}

/// Returns columns and rows of the picture that the rays are, if they have two axes and fit into one.
std::optional<std::pair<int, int>> picture_size(const std::vector<std::uint64_t>& ray_axes) {
    constexpr auto max_side = static_cast<std::uint64_t>(std::numeric_limits<int>::max());
    if (ray_axes.size() != 2 || ray_axes[0] == 0 || ray_axes[1] == 0 || ray_axes[0] > max_side ||
        ray_axes[1] > max_side)
        return {};
    return {{static_cast<int>(ray_axes[1]), static_cast<int>(ray_axes[0])}};
}

}  // namespace

RecordLayout read_npy_layout(toml::ByteSource& source, const ReadOptions& options) {
    const auto [text, begin] = read_header_text(source);
    const std::string& file = source.name();
    const NpyHeader header = read_npy_header(text, file);

    std::vector<std::uint64_t> ray_axes = header.shape;
    RecordLayout array{.columns = {}, .begin = begin, .error_source = file};
    if (header.is_structured) read_structured_layout(header, options, file, array);
    else read_plain_layout(header, options, file, ray_axes, array);

    if (array.record_size == 0) throw InputError(file + ": its records are empty");
    if (array.is_column_major && !source.size())
        throw InputError(file +
                         ": is in Fortran order, which cannot be read from a pipe; write numpy.ascontiguousarray(a)");
    array.picture = picture_size(ray_axes);
    return array;
}

}  // namespace lostbits::scene::ray_file
