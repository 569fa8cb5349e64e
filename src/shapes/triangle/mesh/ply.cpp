#include <array>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "shapes/triangle/mesh/mesh_readers.hpp"
#include "shapes/triangle/mesh/text_lines.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::scene::triangle {

namespace {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };
struct PlyTypeName {
    std::string_view old_name, name;
    std::size_t byte_count;
};
constexpr std::array<PlyTypeName, 8> ply_types{{{"char", "int8", 1},
                                                {"uchar", "uint8", 1},
                                                {"short", "int16", 2},
                                                {"ushort", "uint16", 2},
                                                {"int", "int32", 4},
                                                {"uint", "uint32", 4},
                                                {"float", "float32", 4},
                                                {"double", "float64", 8}}};
std::size_t bytes_of(PlyType type) { return ply_types[static_cast<std::size_t>(type)].byte_count; }

struct PlyProperty {
    std::string name;
    PlyType type{};
    std::optional<PlyType> count = {};  ///< for a list: the type of its length

    [[nodiscard]] bool is_corner_list() const { return name == "vertex_indices" || name == "vertex_index"; }
    [[nodiscard]] bool is_coordinate() const { return name == "x" || name == "y" || name == "z"; }
};
struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties = {};

    [[nodiscard]] bool is_vertex() const { return name == "vertex"; }
    [[nodiscard]] bool is_face() const { return name == "face"; }
    [[nodiscard]] bool has(std::string_view property) const {
        return std::ranges::find(properties, property, &PlyProperty::name) != properties.end();
    }
};
enum class PlyEncoding { text, little, big };
struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::text;
    std::vector<PlyElement> elements = {};
};

/// Reads the lines above `end_header`.
class PlyHeaderLines {
public:
    explicit PlyHeaderLines(TextLines& lines) : lines_(lines) {}

    PlyHeader read() {
        if (!lines_.next() || lines_.word() != "ply") lines_.fail_line("is not a PLY: its first line is not ply");
        while (lines_.next()) {
            const std::string_view keyword = lines_.word();
            if (keyword == "end_header") return check_header();
            if (keyword == "format") read_format();
            else if (keyword == "element") read_element();
            else if (keyword == "property") read_property();
            else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty())
                lines_.fail(
                    text::quoted_excerpt(keyword) +
                    " is not a keyword of a PLY header; write format, element, property, comment or end_header");
        }
        lines_.fail("ends before end_header");
    }

private:
    void read_format() {
        static constexpr std::pair<std::string_view, PlyEncoding> encodings[] = {
            {"ascii", PlyEncoding::text},
            {"binary_little_endian", PlyEncoding::little},
            {"binary_big_endian", PlyEncoding::big}};
        const auto entry =
            std::ranges::find(encodings, lines_.word(), &std::pair<std::string_view, PlyEncoding>::first);
        if (entry == std::end(encodings))
            lines_.fail("the format must be ascii, binary_little_endian or binary_big_endian");
        header_.encoding = entry->second;
        has_format_ = true;
    }
    void read_element() {
        const std::string name(lines_.word());
        if (std::ranges::find(header_.elements, name, &PlyElement::name) != header_.elements.end())
            lines_.fail("a second element " + text::quoted_excerpt(name) + "; write them into one");
        header_.elements.push_back({name, lines_.number<std::uint32_t>("the count of " + text::excerpt(name))});
    }
    void read_property() {
        if (header_.elements.empty()) lines_.fail_line("a property comes before the first element");
        PlyElement& element = header_.elements.back();
        PlyProperty property;
        std::string_view type = lines_.word();
        if (type == "list") {
            property.count = type_named(lines_.word());
            type = lines_.word();
        }
        property.type = type_named(type);
        property.name = lines_.word();
        if (property.name.empty()) lines_.fail("ends before the name of the property");

        // The numbers that a mesh needs have one type each, and are one number or a list as they must be.
        if (element.has(property.name))
            lines_.fail("a second property " + text::quoted_excerpt(property.name) + " of one element");
        if (element.is_face() && property.is_corner_list() &&
            std::ranges::any_of(element.properties, &PlyProperty::is_corner_list))
            lines_.fail("a second list of the corners of a face");
        if (element.is_vertex() && property.is_coordinate() && property.count)
            lines_.fail(property.name + " of a vertex is a list; it must be one number");
        if (element.is_face() && property.is_corner_list() && !property.count)
            lines_.fail(property.name + " of a face is one number; it must be a list");
        element.properties.push_back(property);
    }
    [[nodiscard]] PlyType type_named(std::string_view name) const {
        for (std::size_t k = 0; k < ply_types.size(); ++k)
            if (name == ply_types[k].old_name || name == ply_types[k].name) return static_cast<PlyType>(k);
        lines_.fail(text::quoted_excerpt(name) + " is not a type of PLY; write float, double, uchar, int, …");
    }
    PlyHeader check_header() {
        if (!has_format_) lines_.fail("the header has no format line; write format ascii 1.0 if the numbers are text");
        for (const PlyElement& element : header_.elements) {
            if (element.is_vertex() && !(element.has("x") && element.has("y") && element.has("z")))
                lines_.fail("vertex has no x, y and z");
            if (element.is_face() && std::ranges::none_of(element.properties, &PlyProperty::is_corner_list))
                lines_.fail("face has no list vertex_indices");
            if (element.count > 0 && element.properties.empty())
                lines_.fail("element " + text::excerpt(element.name) +
                            " has no properties, so nothing says where its " +
                            text::count_with_noun(element.count, "element") + " end; leave it out");
        }
        return std::move(header_);
    }

    TextLines& lines_;
    PlyHeader header_;
    bool has_format_ = false;
};

/// Reads the numbers after the header, one after the other, in text or binary.
class PlyNumbers {
public:
    PlyNumbers(TextLines& lines, MeshBytes& bytes, PlyEncoding encoding, const FloatFormat& vertex_format)
        : lines_(lines), bytes_(bytes), encoding_(encoding), vertex_format_(vertex_format) {}

    /// Refuses an element count for which the file is too short, before any element is read.
    void begin(const PlyElement& element) {
        number_start_ = bytes_.position();
        // The smallest size of one element: a list may be empty, and a number in text has at least a digit and a blank.
        std::uint64_t min_bytes = 0;
        for (const PlyProperty& property : element.properties)
            min_bytes += is_text() ? 2 : bytes_of(property.count.value_or(property.type));
        // The last line of a text may lack its line break.
        if (element.count * min_bytes > bytes_.remaining() + 1)
            throw InputError(
                fmt::format("{}: ends before the {} of {}, which take at least {} bytes; was it cut short?",
                            position_text(), text::count_with_noun(element.count, "element"),
                            text::excerpt(element.name), element.count * min_bytes));
    }
    /// Begins an element, which is one line in a text file.
    void begin_element() {
        if (is_text() && !lines_.next()) lines_.fail("ends before all elements are there; was it cut short?");
    }
    void end_element() {
        if (is_text() && !lines_.word().empty())
            lines_.fail("is one value too many: the header lists no more properties of this element");
    }
    /// Refuses data that the header does not name, because it may be faces.
    void end() {
        if (!is_text() && bytes_.remaining() > 0)
            fail(text::count_with_noun(bytes_.remaining(), "byte follows", "bytes follow") +
                 " the last element that the header names");
        while (is_text() && lines_.next())
            if (!lines_.word().empty()) lines_.fail("follows the last element that the header names");
    }

    double next(const PlyProperty& property, PlyType type, const char* prefix = "") {
        if (!is_text()) return number_from_bytes(type);
        const std::string number_name = prefix + property.name;
        switch (type) {
            case PlyType::f32: return lines_.number<float>(number_name);  // rounded once, to the stated type
            case PlyType::f64: return lines_.number<double>(number_name);
            default: return static_cast<double>(lines_.number<long long>(number_name));
        }
    }
    double coordinate(const PlyProperty& property) {
        const double x = next(property, property.type);
        if (const auto fault = reason_to_refuse_coordinate(x, vertex_format_); !fault.empty())
            fail(fmt::format("{} of a vertex is {}, which {}", property.name, x, fault));
        return x;
    }
    /// Reads the length of a list.
    std::size_t length(const PlyProperty& list) {
        constexpr double max_length = 1e6;
        const double x = next(list, *list.count, "the length of ");
        if (!is_whole(x) || x > max_length)
            fail(fmt::format("the length of {} is {}; it must be a whole number up to a million", list.name, x));
        return static_cast<std::size_t>(x);
    }
    /// Skips a number or a list.
    void skip(const PlyProperty& property) {
        const std::size_t count = property.count ? length(property) : 1;
        for (std::size_t k = 0; k < count; ++k) static_cast<void>(next(property, property.type));
    }
    /// Reads the index of a vertex.
    std::uint32_t read_corner(const PlyProperty& property, std::size_t vertex_count) {
        const double x = next(property, property.type);
        if (!is_whole(x) || x >= static_cast<double>(vertex_count))
            fail(fmt::format("names vertex {} of {}; vertices are whole numbers, and count from 0", x, vertex_count));
        return static_cast<std::uint32_t>(x);
    }
    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(position_text() + ": " + problem +
                         (is_text() ? "" : "; is the byte order the one that the format line says?"));
    }

private:
    [[nodiscard]] bool is_text() const { return encoding_ == PlyEncoding::text; }
    /// Returns the position of the word or number that was read last.
    [[nodiscard]] std::string position_text() const {
        return is_text() ? lines_.position() : fmt::format("{}: byte {}", bytes_.name(), number_start_);
    }
    static bool is_whole(double x) { return x >= 0 && x == std::floor(x); }
    template <class T>
    static double copy_number(const std::array<char, 8>& bytes) {
        T x;
        std::memcpy(&x, bytes.data(), sizeof x);
        return static_cast<double>(x);
    }
    double number_from_bytes(PlyType type) {
        const std::size_t byte_count = bytes_of(type);
        number_start_ = bytes_.position();
        const std::string_view read_bytes = bytes_.take(byte_count);
        if (read_bytes.size() < byte_count)
            throw InputError(position_text() + ": ends before all elements are there; was it cut short?");

        // Puts the bytes into the order of this machine.
        std::array<char, 8> bytes{};
        std::ranges::copy(read_bytes, bytes.begin());
        if ((encoding_ == PlyEncoding::little) != (std::endian::native == std::endian::little))
            std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(byte_count));

        switch (type) {
            case PlyType::i8: return copy_number<std::int8_t>(bytes);
            case PlyType::u8: return copy_number<std::uint8_t>(bytes);
            case PlyType::i16: return copy_number<std::int16_t>(bytes);
            case PlyType::u16: return copy_number<std::uint16_t>(bytes);
            case PlyType::i32: return copy_number<std::int32_t>(bytes);
            case PlyType::u32: return copy_number<std::uint32_t>(bytes);
            case PlyType::f32: return copy_number<float>(bytes);
            case PlyType::f64: break;
        }
        return copy_number<double>(bytes);
    }

    TextLines& lines_;
    MeshBytes& bytes_;
    PlyEncoding encoding_;
    FloatFormat vertex_format_;
    std::uint64_t number_start_ = 0;  ///< in a binary file, the byte at which the last number begins
};

void read_vertex(PlyNumbers& numbers, const PlyElement& element, Mesh& mesh) {
    Vec<double> p(0, 0, 0);
    for (const PlyProperty& property : element.properties) {
        if (property.is_coordinate()) p[property.name[0] - 'x'] = numbers.coordinate(property);
        else numbers.skip(property);
    }
    mesh.vertices.push_back(p);
}

/// Reads the corners of a face, or skips an element of another kind.
void read_corners(PlyNumbers& numbers, const PlyElement& element, std::size_t vertex_count,
                  std::vector<std::uint32_t>& corners) {
    corners.clear();
    for (const PlyProperty& property : element.properties) {
        if (!element.is_face() || !property.is_corner_list()) {
            numbers.skip(property);
            continue;
        }
        const std::size_t count = numbers.length(property);
        for (std::size_t k = 0; k < count; ++k) corners.push_back(numbers.read_corner(property, vertex_count));
    }
}

}  // namespace

ParsedMesh read_ply(MeshBytes& bytes, const MeshSettings& settings) {
    ParsedMesh parsed_mesh;
    TextLines lines(bytes);
    const PlyHeader header = PlyHeaderLines(lines).read();
    PlyNumbers numbers(lines, bytes, header.encoding, settings.vertex_format);
    std::vector<std::uint32_t> corners;

    for (const PlyElement& element : header.elements) {
        numbers.begin(element);
        if (element.is_vertex()) parsed_mesh.mesh.vertices.reserve(element.count);
        for (std::size_t i = 0; i < element.count; ++i) {
            numbers.begin_element();
            if (element.is_vertex()) read_vertex(numbers, element, parsed_mesh.mesh);
            else read_corners(numbers, element, parsed_mesh.mesh.vertices.size(), corners);

            if (element.is_face() && corners.size() < 3) numbers.fail("a face has fewer than 3 corners");
            if (element.is_face()) parsed_mesh.add(corners, i);
            if (parsed_mesh.mesh.faces.size() > max_faces) numbers.fail("has more than 2^31 - 1 triangles");
            numbers.end_element();
        }
    }
    numbers.end();
    return parsed_mesh;
}

}  // namespace lostbits::scene::triangle
