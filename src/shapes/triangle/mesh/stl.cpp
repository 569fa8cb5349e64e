#include <bit>
#include <cstring>

#include "scene/toml/counted.hpp"
#include "shapes/triangle/mesh/mesh_readers.hpp"
#include "shapes/triangle/mesh/text_lines.hpp"

namespace lostbits::scene::triangle {

namespace {

constexpr std::size_t head = 84, record = 50;

MeshInFile read_stl_text(const std::filesystem::path& path, std::istream& bytes) {
    MeshInFile found;
    TextLines lines(path, bytes);
    std::size_t since = 0;  // corners of the facet so far
    while (lines.next()) {
        const std::string_view what = lines.word();
        if (what == "facet") since = 0;
        if (what == "vertex") {
            const double x = lines.number<double>("x"), y = lines.number<double>("y"), z = lines.number<double>("z");
            const auto place = static_cast<std::uint32_t>(found.mesh.vertices.size());
            found.mesh.vertices.emplace_back(x, y, z);
            if (++since == 3) found.add({place - 2, place - 1, place}, lines.line());
        }
        if (what == "endfacet" && since != 3)
            lines.fail("ends a facet of " + scene::toml::counted(since, "vertex", "vertices") + "; an STL facet has 3");
    }
    return found;
}

}  // namespace

MeshInFile read_stl(const std::filesystem::path& path, std::istream& bytes) {
    static_assert(std::endian::native == std::endian::little, "the numbers of an STL are");
    bytes.seekg(0, std::ios::end);
    const auto size = static_cast<std::size_t>(bytes.tellg());
    bytes.seekg(0);
    char start[head] = {};
    bytes.read(start, head);
    std::uint32_t count = 0;
    std::memcpy(&count, start + 80, 4);
    if (size < head || size != head + record * std::size_t{count}) {
        if (std::string_view(start, 5) != "solid")
            throw InputError(path.string() + ": is not an STL: it does not begin with the word solid, and with " +
                             std::to_string(count) + " facets it would have " +
                             std::to_string(head + record * std::size_t{count}) + " bytes and not " +
                             std::to_string(size) + "; was it cut short?");
        bytes.clear();
        bytes.seekg(0);
        return read_stl_text(path, bytes);
    }
    MeshInFile found;
    for (std::uint32_t f = 0; f < count; ++f) {
        char facet[record];
        bytes.read(facet, record);
        float numbers[9];
        std::memcpy(numbers, facet + 12, sizeof numbers);
        for (int k = 0; k < 9; ++k)
            if (!std::isfinite(numbers[k]))
                throw InputError(path.string() + ": byte " + std::to_string(head + record * f + 12 + 4 * k) +
                                 ": facet " + std::to_string(f) + " has a vertex that is not finite");
        const auto place = static_cast<std::uint32_t>(found.mesh.vertices.size());
        for (int k = 0; k < 3; ++k)
            found.mesh.vertices.emplace_back(numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]);
        found.add({place, place + 1, place + 2}, f);
    }
    return found;
}

}  // namespace lostbits::scene::triangle
