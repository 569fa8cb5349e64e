#include <bit>

#include <fmt/format.h>

#include "scene/toml/counted.hpp"
#include "shapes/triangle/mesh/mesh_readers.hpp"
#include "shapes/triangle/mesh/text_lines.hpp"

namespace lostbits::scene::triangle {

namespace {

constexpr std::size_t head = 84, record = 50;

/// Reads the words of an STL in text: solid, then facets, then endsolid.
class StlText {
public:
    StlText(MeshBytes& bytes, const FloatFormat& stored) : lines_(bytes), stored_(stored) {}

    MeshInFile read() {
        while (lines_.next())
            if (const std::string_view what = lines_.word(); !what.empty()) take(what);
        if (stands_ != Stands::outside)
            lines_.fail_line(stands_ == Stands::in_facet ? "ends inside of a facet; was it cut short?"
                                                         : "ends before endsolid; was it cut short?");
        return std::move(found_);
    }

private:
    enum class Stands { outside, in_solid, in_facet };

    void take(std::string_view what) {
        if (what == "solid") step(Stands::outside, Stands::in_solid);
        else if (what == "facet") step(Stands::in_solid, Stands::in_facet), corners_ = 0;
        else if (what == "vertex") take_vertex();
        else if (what == "endfacet") end_facet();
        else if (what == "endsolid") step(Stands::in_solid, Stands::outside);
        else if (what != "outer" && what != "endloop")
            lines_.fail(toml::quoted_excerpt(what) + " is not a keyword of STL; is it an STL?");
    }
    void step(Stands from, Stands to) {
        if (stands_ != from)
            lines_.fail("is not allowed " + std::string(where_words[static_cast<std::size_t>(stands_)]));
        stands_ = to;
    }
    void take_vertex() {
        step(Stands::in_facet, Stands::in_facet);
        const auto number = [&](const char* name) { return lines_.coordinate<double>(name, stored_); };
        const double x = number("x"), y = number("y"), z = number("z");
        const auto place = static_cast<std::uint32_t>(found_.mesh.vertices.size());
        found_.mesh.vertices.emplace_back(x, y, z);
        if (++corners_ == 3) found_.add(std::array{place - 2, place - 1, place}, lines_.line());
        if (found_.mesh.faces.size() > most_vertices / 3) lines_.fail_line("has more than 2^32 - 1 vertices");
    }
    void end_facet() {
        step(Stands::in_facet, Stands::in_solid);
        if (corners_ != 3)
            lines_.fail_line("ends a facet of " + scene::toml::counted(corners_, "vertex", "vertices") +
                             "; an STL facet has 3");
    }

    static constexpr std::string_view where_words[] = {"outside of a solid", "in a solid, outside of its facets",
                                                       "inside of a facet, which endfacet ends"};
    TextLines lines_;
    FloatFormat stored_;
    MeshInFile found_;
    Stands stands_ = Stands::outside;
    std::size_t corners_ = 0;  ///< number of vertices of the facet so far
};

}  // namespace

MeshInFile read_stl(MeshBytes& bytes, const MeshTerms& terms) {
    static_assert(std::endian::native == std::endian::little, "STL is little endian, and its numbers are copied");
    const std::string start(bytes.look(head));
    std::uint32_t count = 0;
    if (start.size() == head) std::memcpy(&count, start.data() + 80, 4);
    const std::uint64_t size = head + record * std::uint64_t{count};
    if (start.size() < head || bytes.size() != size) {
        const bool is_text =
            std::string_view(start).substr(start.starts_with("\xEF\xBB\xBF") ? 3 : 0).starts_with("solid");
        if (is_text) return StlText(bytes, terms.stored).read();
        throw InputError(
            fmt::format("{}: byte {}: is not an STL: it does not begin with the word solid, and with {} it "
                        "would have {} bytes and not {}; was it cut short?",
                        bytes.name(), start.size() < head ? 0 : 80, toml::counted(count, "facet"), size, bytes.size()));
    }
    MeshInFile found;
    bytes.take(head);
    for (std::uint32_t f = 0; f < count; ++f) {
        const std::uint64_t begin = bytes.place();
        const std::string_view facet = bytes.take(record);
        if (facet.size() < record)
            throw InputError(fmt::format("{}: byte {}: ends inside of a facet", bytes.name(), begin));
        float numbers[9];
        std::memcpy(numbers, facet.data() + 12, sizeof numbers);
        for (std::size_t k = 0; k < 9; ++k)
            if (const auto fault = fault_of_coordinate(numbers[k], terms.stored); !fault.empty())
                throw InputError(fmt::format("{}: byte {}: facet {} has a vertex that {}", bytes.name(),
                                             begin + 12 + 4 * k, f, fault));
        const auto place = static_cast<std::uint32_t>(found.mesh.vertices.size());
        for (int k = 0; k < 3; ++k)
            found.mesh.vertices.emplace_back(numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]);
        found.add(std::array{place, place + 1, place + 2}, f);
    }
    return found;
}

}  // namespace lostbits::scene::triangle
