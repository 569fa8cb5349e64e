#include "shapes/triangle/mesh/mesh_readers.hpp"
#include "shapes/triangle/mesh/text_lines.hpp"

namespace lostbits::scene::triangle {

namespace {

/// The keywords of the other lines of an OBJ, the usual ones first.
constexpr std::string_view other_keywords[] = {
    "vn",       "vt",       "#",     "g",     "o",      "s",      "usemtl",     "mtllib",   "l",    "p",
    "vp",       "mg",       "lod",   "bevel", "call",   "csh",    "cstype",     "deg",      "bmat", "step",
    "curv",     "curv2",    "surf",  "parm",  "trim",   "hole",   "scrv",       "sp",       "end",  "con",
    "c_interp", "d_interp", "ctech", "stech", "usemap", "maplib", "shadow_obj", "trace_obj"};

bool is_ignored(std::string_view keyword) {
    return keyword.empty() || keyword[0] == '#' ||
           std::ranges::find(other_keywords, keyword) != std::end(other_keywords);
}

/// Returns the index of a vertex, from 0, for `7`, `7/1`, `7/1/2`, `7//2` or `-1`.
std::uint32_t parse_vertex_index(const TextLines& lines, std::string_view word, std::size_t vertex_count) {
    const std::string_view text = word.substr(0, word.find('/'));
    long long number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size())
        lines.fail("the corner " + text::quoted_excerpt(word) + " is not the number of a vertex");
    const auto count = static_cast<long long>(vertex_count);
    if (number == 0) lines.fail("names vertex 0; vertices count from 1, and -1 is the last one");
    if (number > count || number < -count)
        lines.fail("names vertex " + std::to_string(number) + ", but " + std::to_string(count) +
                   " are defined above; vertices count from 1, and a face follows its vertices");
    return static_cast<std::uint32_t>(number > 0 ? number - 1 : count + number);
}

/// Refuses a vertex or a face on a line that continues a statement. A comment may end with a backslash by accident, and
/// the line below it would be ignored.
void require_no_element(const TextLines& lines, std::string_view word) {
    if (word == "v" || word == "f")
        lines.fail(text::quoted_excerpt(word) +
                   " begins a line that continues the one above, which ends with \\, so a vertex or a face might be "
                   "left out; remove the \\, or write this line elsewhere");
}

/// Skips the rest of a statement, including the lines on which it continues.
void skip_rest(TextLines& lines) {
    while (lines.next_continuation()) require_no_element(lines, lines.word());
}

/// Skips the numbers that may follow x, y and z: a weight or a colour. Any other word is refused, because it may be
/// part of a coordinate.
void skip_more_numbers(TextLines& lines) {
    for (std::string_view word = lines.word(); !word.empty() && word[0] != '#'; word = lines.word()) {
        require_no_element(lines, word);
        double x = 0;
        const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
        if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
            lines.fail(text::quoted_excerpt(word) +
                       " follows the x, y and z of a vertex and is not a number; a weight or a colour may follow them, "
                       "so correct it or remove it");
    }
}

void read_vertex_statement(TextLines& lines, const FloatFormat& vertex_format, ParsedMesh& parsed_mesh) {
    if (parsed_mesh.mesh.vertices.size() == max_vertices) lines.fail("is one vertex too many; the limit is 2^32 - 1");
    const auto number = [&](const char* name) { return lines.coordinate<double>(name, vertex_format); };
    const double x = number("x"), y = number("y"), z = number("z");
    parsed_mesh.mesh.vertices.emplace_back(x, y, z);
    skip_more_numbers(lines);
}

/// Reads a face. `corners` is a buffer.
void read_face_statement(TextLines& lines, std::vector<std::uint32_t>& corners, ParsedMesh& parsed_mesh) {
    corners.clear();
    for (std::string_view word = lines.word(); !word.empty(); word = lines.word())
        corners.push_back(parse_vertex_index(lines, word, parsed_mesh.mesh.vertices.size()));
    if (corners.size() < 3) lines.fail_line("is a face of fewer than 3 corners");
    parsed_mesh.add(corners, lines.line());
    if (parsed_mesh.mesh.faces.size() > max_faces)
        lines.fail_line("is one face too many; the limit is 2^31 - 1 triangles");
}

}  // namespace

ParsedMesh read_obj(MeshBytes& bytes, const MeshSettings& settings) {
    ParsedMesh parsed_mesh;
    TextLines lines(bytes, StatementKind::continued_by_backslash);
    std::vector<std::uint32_t> corners;
    while (lines.next()) {
        const std::string_view keyword = lines.word();
        if (keyword == "v") read_vertex_statement(lines, settings.vertex_format, parsed_mesh);
        else if (keyword == "f") read_face_statement(lines, corners, parsed_mesh);
        else if (!is_ignored(keyword))
            lines.fail(text::quoted_excerpt(keyword) +
                       " is not a keyword of OBJ, so a face might be left out; correct it, or write # before "
                       "it");
        skip_rest(lines);
    }
    return parsed_mesh;
}

}  // namespace lostbits::scene::triangle
