#include "shapes/triangle/mesh/mesh_readers.hpp"
#include "shapes/triangle/mesh/text_lines.hpp"

namespace lostbits::scene::triangle {

namespace {

/// `7`, `7/1`, `7/1/2`, `7//2`, `-1`: the place of the vertex from 0.
std::uint32_t corner(const TextLines& lines, std::string_view word, std::size_t vertices) {
    const std::string_view text = word.substr(0, word.find('/'));
    long long place = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), place);
    if (error != std::errc() || end != text.data() + text.size())
        lines.fail("the corner \"" + std::string(word.substr(0, 40)) + "\" is not the number of a vertex");
    const auto count = static_cast<long long>(vertices);
    if (place == 0) lines.fail("names vertex 0; vertices count from 1, and -1 is the last one");
    if (place > count || place < -count)
        lines.fail("names vertex " + std::to_string(place) + ", and " + std::to_string(count) +
                   " stand above; vertices count from 1, and a face follows its vertices");
    return static_cast<std::uint32_t>(place > 0 ? place - 1 : count + place);
}

}  // namespace

MeshInFile read_obj(const std::filesystem::path& path, std::istream& bytes) {
    MeshInFile found;
    TextLines lines(path, bytes);
    std::vector<std::uint32_t> corners;
    while (lines.next()) {
        const std::string_view what = lines.word();
        if (what == "v") {
            if (found.mesh.vertices.size() == most_vertices)
                lines.fail("is one vertex too many: 2^32 - 1 are the most");
            const double x = lines.number<double>("x"), y = lines.number<double>("y"), z = lines.number<double>("z");
            found.mesh.vertices.emplace_back(x, y, z);
        } else if (what == "f") {
            corners.clear();
            for (std::string_view word = lines.word(); !word.empty(); word = lines.word())
                corners.push_back(corner(lines, word, found.mesh.vertices.size()));
            if (corners.size() < 3) lines.fail("is a face of fewer than 3 corners");
            found.add(corners, lines.line());
        }
    }
    return found;
}

}  // namespace lostbits::scene::triangle
