#include <bit>

#include <fmt/format.h>

#include "shapes/triangle/mesh/mesh_readers.hpp"
#include "shapes/triangle/mesh/text_lines.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::scene::triangle {

namespace {

/// Sizes in bytes. The header ends with the count of facets, and a facet begins with its normal.
constexpr std::size_t header_size = 84, count_position = 80, facet_size = 50, normal_size = 12;

/// Reads an STL in ASCII: solid, then facets, then endsolid.
class AsciiStlReader {
public:
    AsciiStlReader(MeshBytes& bytes, const FloatFormat& vertex_format) : lines_(bytes), vertex_format_(vertex_format) {}

    ParsedMesh read() {
        while (lines_.next())
            if (const std::string_view keyword = lines_.word(); !keyword.empty()) read_keyword(keyword);
        if (position_ != Position::outside)
            lines_.fail_line(position_ == Position::in_facet ? "ends inside of a facet; was it cut short?"
                                                             : "ends before endsolid; was it cut short?");
        return std::move(parsed_mesh_);
    }

private:
    enum class Position { outside, in_solid, in_facet };

    void read_keyword(std::string_view keyword) {
        if (keyword == "solid") require_and_move(Position::outside, Position::in_solid);
        else if (keyword == "facet") begin_facet();
        else if (keyword == "vertex") read_vertex_line();
        else if (keyword == "endfacet") end_facet();
        else if (keyword == "endsolid") require_and_move(Position::in_solid, Position::outside);
        else if (keyword != "outer" && keyword != "endloop")
            lines_.fail(text::quoted_excerpt(keyword) + " is not a keyword of STL; is it an STL?");
    }
    void require_and_move(Position expected, Position next) {
        if (position_ != expected)
            lines_.fail("is not allowed " + std::string(position_texts[static_cast<std::size_t>(position_)]));
        position_ = next;
    }
    void begin_facet() {
        require_and_move(Position::in_solid, Position::in_facet);
        corner_count_ = 0;
    }
    void read_vertex_line() {
        require_and_move(Position::in_facet, Position::in_facet);
        const auto number = [&](const char* name) { return lines_.coordinate<double>(name, vertex_format_); };
        const double x = number("x"), y = number("y"), z = number("z");
        const auto index = static_cast<std::uint32_t>(parsed_mesh_.mesh.vertices.size());
        parsed_mesh_.mesh.vertices.emplace_back(x, y, z);
        if (++corner_count_ == 3) parsed_mesh_.add(std::array{index - 2, index - 1, index}, lines_.line());
        if (parsed_mesh_.mesh.faces.size() > max_vertices / 3) lines_.fail_line("has more than 2^32 - 1 vertices");
    }
    void end_facet() {
        require_and_move(Position::in_facet, Position::in_solid);
        if (corner_count_ != 3)
            lines_.fail_line("ends a facet of " + text::count_with_noun(corner_count_, "vertex", "vertices") +
                             "; an STL facet has 3");
    }

    static constexpr std::string_view position_texts[] = {"outside of a solid", "in a solid, outside of its facets",
                                                          "inside of a facet, which endfacet ends"};
    TextLines lines_;
    FloatFormat vertex_format_;
    ParsedMesh parsed_mesh_;
    Position position_ = Position::outside;
    std::size_t corner_count_ = 0;  ///< number of vertices of the facet so far
};

/// Reads a facet: three vertices of three floats, between a normal and two bytes that are ignored.
void read_binary_facet(MeshBytes& bytes, std::uint32_t index, const FloatFormat& vertex_format,
                       ParsedMesh& parsed_mesh) {
    const std::uint64_t begin = bytes.position();
    const std::string_view facet = bytes.take(facet_size);
    if (facet.size() < facet_size)
        throw InputError(fmt::format("{}: byte {}: ends inside of a facet", bytes.name(), begin));
    float numbers[9];
    std::memcpy(numbers, facet.data() + normal_size, sizeof numbers);
    for (std::size_t k = 0; k < 9; ++k)
        if (const auto fault = reason_to_refuse_coordinate(numbers[k], vertex_format); !fault.empty())
            throw InputError(fmt::format("{}: byte {}: facet {} has a vertex that {}", bytes.name(),
                                         begin + normal_size + 4 * k, index, fault));

    const auto first_index = static_cast<std::uint32_t>(parsed_mesh.mesh.vertices.size());
    for (int k = 0; k < 3; ++k)
        parsed_mesh.mesh.vertices.emplace_back(numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]);
    parsed_mesh.add(std::array{first_index, first_index + 1, first_index + 2}, index);
}

}  // namespace

ParsedMesh read_stl(MeshBytes& bytes, const MeshSettings& settings) {
    static_assert(std::endian::native == std::endian::little, "STL is little endian, and its numbers are copied");
    const std::string first_bytes(bytes.peek(header_size));
    std::uint32_t count = 0;
    if (first_bytes.size() == header_size) std::memcpy(&count, first_bytes.data() + count_position, sizeof count);

    // A binary STL has the size that its count of facets gives. Its header may begin with the word solid, too.
    const std::uint64_t size = header_size + facet_size * std::uint64_t{count};
    if (first_bytes.size() < header_size || bytes.size() != size) {
        const bool is_text =
            std::string_view(first_bytes).substr(first_bytes.starts_with("\xEF\xBB\xBF") ? 3 : 0).starts_with("solid");
        if (is_text) return AsciiStlReader(bytes, settings.vertex_format).read();
        throw InputError(
            fmt::format("{}: byte {}: is not an STL: it does not begin with the word solid, and with {} it "
                        "would have {} bytes and not {}; was it cut short?",
                        bytes.name(), first_bytes.size() < header_size ? 0 : count_position,
                        text::count_with_noun(count, "facet"), size, bytes.size()));
    }

    ParsedMesh parsed_mesh;
    bytes.take(header_size);
    for (std::uint32_t f = 0; f < count; ++f) read_binary_facet(bytes, f, settings.vertex_format, parsed_mesh);
    return parsed_mesh;
}

}  // namespace lostbits::scene::triangle
