#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "shapes/triangle/mesh/mesh_readers.hpp"
#include "shapes/triangle/mesh/text_lines.hpp"

namespace lostbits::scene::triangle {

namespace {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };
struct PlyTypeName {
    std::string_view old_name, name;
    std::size_t bytes;
};
constexpr std::array<PlyTypeName, 8> ply_types{{{"char", "int8", 1},
                                                {"uchar", "uint8", 1},
                                                {"short", "int16", 2},
                                                {"ushort", "uint16", 2},
                                                {"int", "int32", 4},
                                                {"uint", "uint32", 4},
                                                {"float", "float32", 4},
                                                {"double", "float64", 8}}};

struct PlyProperty {
    std::string name;
    PlyType type{};
    std::optional<PlyType> count = {};  ///< of a list: the type of how many follow
};
struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties = {};
};
enum class PlyBytes { text, little, big };
struct PlyHeader {
    PlyBytes bytes = PlyBytes::text;
    std::vector<PlyElement> elements = {};
};

PlyType type_named(const TextLines& lines, std::string_view name) {
    for (std::size_t k = 0; k < ply_types.size(); ++k)
        if (name == ply_types[k].old_name || name == ply_types[k].name) return static_cast<PlyType>(k);
    lines.fail("\"" + std::string(name.substr(0, 40)) + "\" is not a type of PLY; write float, double, uchar, int, …");
}

PlyHeader read_header(TextLines& lines) {
    if (!lines.next() || lines.word() != "ply") lines.fail("is not a PLY: its first line is not ply");
    PlyHeader header;
    while (lines.next()) {
        const std::string_view what = lines.word();
        if (what == "end_header") return header;
        if (what == "format") {
            const std::string_view name = lines.word();
            if (name == "binary_little_endian") header.bytes = PlyBytes::little;
            else if (name == "binary_big_endian") header.bytes = PlyBytes::big;
            else if (name != "ascii") lines.fail("the format is ascii, binary_little_endian or binary_big_endian");
        } else if (what == "element") {
            const std::string name(lines.word());
            header.elements.push_back({name, lines.number<std::uint32_t>("the count of " + name)});
        } else if (what == "property") {
            if (header.elements.empty()) lines.fail("a property stands before the first element");
            PlyProperty property;
            std::string_view type = lines.word();
            if (type == "list") property.count = type_named(lines, lines.word()), type = lines.word();
            property.type = type_named(lines, type);
            property.name = lines.word();
            header.elements.back().properties.push_back(property);
        }
    }
    lines.fail("ends before end_header");
}

/// The numbers of the body, one after the other.
class PlyNumbers {
public:
    PlyNumbers(TextLines& lines, std::istream& stream, PlyBytes bytes, const std::filesystem::path& path)
        : lines_(lines), stream_(stream), bytes_(bytes), path_(path) {}

    /// A line of text is an element.
    void begin_element() {
        if (bytes_ == PlyBytes::text && !lines_.next()) lines_.fail("ends before all elements are there");
    }
    double next(PlyType type, const std::string& what) {
        if (bytes_ != PlyBytes::text) return from_bytes(type);
        switch (type) {
            case PlyType::f32: return lines_.number<float>(what);  // rounded once, to the type that is stated
            case PlyType::f64: return lines_.number<double>(what);
            default: return static_cast<double>(lines_.number<long long>(what));
        }
    }
    [[nodiscard]] std::string place() const {
        return bytes_ == PlyBytes::text
                   ? lines_.place()
                   : path_.string() + ": byte " + std::to_string(static_cast<long long>(stream_.tellg()));
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(place() + ": " + what +
                         (bytes_ == PlyBytes::text ? "" : "; is the order of bytes the one that format says?"));
    }

private:
    template <class T>
    static double as(const std::array<char, 8>& raw) {
        T x;
        std::memcpy(&x, raw.data(), sizeof x);
        return static_cast<double>(x);
    }
    double from_bytes(PlyType type) {
        const std::size_t count = ply_types[static_cast<std::size_t>(type)].bytes;
        std::array<char, 8> raw{};
        if (!stream_.read(raw.data(), static_cast<std::streamsize>(count)))
            throw InputError(path_.string() + ": ends before all elements are there; was it cut short?");
        if ((bytes_ == PlyBytes::little) != (std::endian::native == std::endian::little))
            std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(count));
        switch (type) {
            case PlyType::i8: return as<std::int8_t>(raw);
            case PlyType::u8: return as<std::uint8_t>(raw);
            case PlyType::i16: return as<std::int16_t>(raw);
            case PlyType::u16: return as<std::uint16_t>(raw);
            case PlyType::i32: return as<std::int32_t>(raw);
            case PlyType::u32: return as<std::uint32_t>(raw);
            case PlyType::f32: return as<float>(raw);
            case PlyType::f64: break;
        }
        return as<double>(raw);
    }

    TextLines& lines_;
    std::istream& stream_;
    PlyBytes bytes_;
    const std::filesystem::path& path_;
};

void read_vertex(PlyNumbers& numbers, const PlyElement& element, Mesh& mesh) {
    Vec<double> p(0, 0, 0);
    for (const PlyProperty& property : element.properties) {
        if (property.count) numbers.fail("vertex has a list, which is not read");
        const double x = numbers.next(property.type, property.name);
        if (property.name.size() != 1 || property.name[0] < 'x' || property.name[0] > 'z') continue;
        if (!std::isfinite(x)) numbers.fail(property.name + " of a vertex is not finite");
        p[property.name[0] - 'x'] = x;
    }
    mesh.vertices.push_back(p);
}

/// Reads the lists of a face, or of an element that is not wanted.
void read_lists(PlyNumbers& numbers, const PlyElement& element, std::size_t vertices,
                std::vector<std::uint32_t>& corners) {
    constexpr double most_corners = 1e6;
    corners.clear();
    for (const PlyProperty& property : element.properties) {
        const bool wanted = property.name == "vertex_indices" || property.name == "vertex_index";
        const double count = property.count ? numbers.next(*property.count, "the length of " + property.name) : 1;
        if (!(count >= 0 && count <= most_corners))
            numbers.fail("the length of " + property.name + " is " + std::to_string(count));
        for (double k = 0; k < count; ++k) {
            const double x = numbers.next(property.type, property.name);
            if (!wanted) continue;
            if (!(x >= 0 && x < static_cast<double>(vertices)))
                numbers.fail("names vertex " + std::to_string(static_cast<long long>(x)) + " of " +
                             std::to_string(vertices) + "; vertices count from 0");
            corners.push_back(static_cast<std::uint32_t>(x));
        }
    }
}

}  // namespace

MeshInFile read_ply(const std::filesystem::path& path, std::istream& bytes) {
    MeshInFile found;
    TextLines lines(path, bytes);
    const PlyHeader header = read_header(lines);
    PlyNumbers numbers(lines, bytes, header.bytes, path);
    std::vector<std::uint32_t> corners;
    for (const PlyElement& element : header.elements) {
        const auto has = [&](const char* name) {
            return std::ranges::find(element.properties, name, &PlyProperty::name) != element.properties.end();
        };
        const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
        if (is_vertex && !(has("x") && has("y") && has("z"))) lines.fail("vertex has no x, y and z");
        if (is_face && !has("vertex_indices") && !has("vertex_index")) lines.fail("face has no list vertex_indices");
        for (std::size_t i = 0; i < element.count; ++i) {
            numbers.begin_element();
            if (is_vertex) {
                read_vertex(numbers, element, found.mesh);
                continue;
            }
            read_lists(numbers, element, found.mesh.vertices.size(), corners);
            if (is_face && corners.size() < 3) numbers.fail("a face has fewer than 3 corners");
            if (is_face) found.add(corners, i);
        }
    }
    return found;
}

}  // namespace lostbits::scene::triangle
