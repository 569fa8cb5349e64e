// Mesh files: vertices keep the bits of the file, and a file that is not a mesh is refused with its position.
#include "catch.hpp"
#include "counts.hpp"
#include "scene/file/mesh_text.hpp"
#include "shapes/triangle/mesh/made.hpp"

namespace test_mesh_file {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::test;

TEST_CASE("vertices keep the bits of the file", "[mesh]") {
    const Scratch folder;
    const auto arrives = [&](const char* name, const Mesh& mesh, const std::string& bytes) {
        INFO(name);
        CHECK(are_same(read_mesh_file(folder.write(name, bytes)), mesh));
    };
    const Mesh wide = draw_mesh(false), narrow = draw_mesh(true);
    arrives("wide.obj", wide, to_obj(wide));
    arrives("wide.ply", wide, to_ply_text<double>(wide));
    arrives("wide-little.ply", wide, to_ply_bytes<double>(wide, false));
    arrives("wide-big.ply", wide, to_ply_bytes<double>(wide, true));
    arrives("wide.stl", wide, to_stl_text(wide));
    arrives("narrow.obj", narrow, to_obj(narrow));
    arrives("narrow.ply", narrow, to_ply_text<float>(narrow));
    arrives("narrow-little.ply", narrow, to_ply_bytes<float>(narrow, false));
    arrives("narrow-big.ply", narrow, to_ply_bytes<float>(narrow, true));
    arrives("narrow.stl", narrow, to_stl_bytes(narrow));
    arrives("narrow.glb", narrow, to_glb(narrow));
    folder.write("narrow.bin", buffer_of_gltf(narrow));
    arrives("narrow.gltf", narrow, to_gltf(narrow, R"(, "uri": "narrow.bin")"));
}

TEST_CASE("a file without indices gives a mesh as closed as the one written", "[mesh]") {
    Mesh ball = scene::triangle::make_icosphere(2, {0, 0, 0}, 1);
    for (auto& v : ball.vertices)
        for (int k = 0; k < 3; ++k) v[k] = static_cast<float>(v[k]);
    const Scratch folder;
    for (const auto& path : {folder.write("a.stl", to_stl_bytes(ball)), folder.write("b.stl", to_stl_text(ball)),
                             folder.write("c.obj", to_obj(ball))}) {
        const Mesh read = read_mesh_file(path);
        CHECK(read.vertices.size() == ball.vertices.size());
        CHECK(2 * find_shared_edges(read).size() == 3 * ball.faces.size());
        CHECK(are_same(read, ball));
    }
}

TEST_CASE("a polygon becomes a fan around its first corner, and a degenerate face is named", "[mesh]") {
    const Scratch folder;
    const Mesh mesh =
        read_mesh_file(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 2 5\nf 1 2 3 4\n"));
    REQUIRE(mesh.faces.size() == 2);
    CHECK(mesh.triangle(1).c == Vec<double>(0, 1, 0));
    CHECK(mesh.removed_face_count == 1);
    CHECK(mesh.first_removed_face.ends_with("a.obj:6"));
}

TEST_CASE("a line of an OBJ file continues after a backslash at its end", "[mesh]") {
    const Scratch folder;
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    const Mesh plain = read_mesh_file(folder.write("plain.obj", corners + "f 1 2 3 4\nf 1/1/1 2/2/2 4/4/4\n"));
    const std::string continued[] = {
        corners + "f 1 2 \\\n3 4\nf 1/1/1 2/2/2 4/4/4\n",
        corners + "f 1 2 \\\r\n  3\\\r\n4\r\nf 1/1/1 2/2/2 4/4/4\r\n",  // a break is a blank, as in Blender
        corners + "f \\ \t\n\\\n1 2 3 4 \\\n\nf\\\n1/1/1 2/2/2\\\n4/4/4",
        "v 0 0 0 \\\n1.0\nv 1 \\\n0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf 1/1/1 2/2/2 4/4/4\n",
        "# a comment \\\n# and one more\n" + corners + "curv2 1 2 \\\n3 4\nf 1 2 3 4\nf 1 2 4\n# the end \\\n"};
    for (const std::string& text : continued) {
        INFO(text);
        CHECK(are_same(read_mesh_file(folder.write("a.obj", text)), plain));
    }
    CHECK(error_of_file("a.obj", corners + "f 1 2 \\\n 3 9\nf 1 2 3\n").starts_with("a.obj:6:4: names vertex 9"));
    CHECK(error_of_file("a.obj", corners + "f 1 2 \\\n3 4\nf 1 2 9\n").starts_with("a.obj:7:7: names vertex 9"));
    CHECK(error_of_file("a.obj", corners + "  f 1 \\\n2\n") == "a.obj:5:3: is a face of fewer than 3 corners");
    CHECK(error_of_file("a.obj", corners + "f 1 2 \\\nf 3 4\n") ==
          "a.obj:6:1: the corner \"f\" is not the number of a vertex");
    CHECK(error_of_file("a.obj", corners + "f 1 2\\3 4\n") ==
          "a.obj:5:5: the corner \"2\\3\" is not the number of a vertex");
    CHECK(error_of_file("a.obj", corners + "f 1 2 3 \\") ==
          "a.obj:5:9: continues on the next line, but the file ends here; was it cut short?");
    for (const char* const above : {"v 1 2 3 \\", "# in C:\\meshes\\", "usemtl a\\"})
        CHECK(error_of_file("a.obj", corners + above + "\nv 7 7 7\nf 1 2 3\n")
                  .starts_with("a.obj:6:1: \"v\" begins a line that continues the one above"));
    CHECK(read_mesh_file(folder.write("line.obj", corners + "f 1 \\\n2 1\nf 1 2 3\n"))
              .first_removed_face.ends_with("line.obj:5"));
    CHECK(has(error_of_file("a.stl", "solid a \\\nfacet"), "a.stl:2"));  // no other kind of file continues lines
}

TEST_CASE("a file that is not a mesh is refused with its line or offset", "[mesh]") {
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    CHECK(error_of_file("a.obj", three + "f 1 2 4\n") ==
          "a.obj:4:7: names vertex 4, but 3 are defined above; vertices count from 1, and a face follows its vertices");
    CHECK(error_of_file("a.obj", three + "f 0 1 2\n") ==
          "a.obj:4:3: names vertex 0; vertices count from 1, and -1 is the last one");
    CHECK(error_of_file("a.obj", three + " f 1 2\n") == "a.obj:4:2: is a face of fewer than 3 corners");
    CHECK(error_of_file("a.obj", three + "f 1 2 x\n") == "a.obj:4:7: the corner \"x\" is not the number of a vertex");
    CHECK(error_of_file("a.obj", "v 0 1 2 x\n")
              .starts_with("a.obj:1:9: \"x\" follows the x, y and z of a vertex and is not a number"));
    CHECK(error_of_file("a.obj", "v 0 1 2 0.5 1,5\n").starts_with("a.obj:1:13: \"1,5\" follows"));
    CHECK(read_mesh_file(Scratch().write("a.obj", "v 0 0 0 1\nv 1 0 0 +.5 1e-3 0 # red\nv 0 1 0 #\nf 1 2 3\n"))
              .faces.size() == 1);
    CHECK(error_of_file("a.obj", "v 0 nan 0\n") ==
          "a.obj:1:5: y is \"nan\", which is not finite; a vertex has finite numbers");
    CHECK(error_of_file("a.obj", "v 0 1e999 0\n") == "a.obj:1:5: y is \"1e999\", which overflows");
    const std::string not_a_number = ", which is not a number; write a decimal with a point, such as 0.5 or 1e-3";
    CHECK(error_of_file("a.obj", "v 0 +-1 0\n") == "a.obj:1:5: y is \"+-1\"" + not_a_number);
    CHECK(error_of_file("a.obj", "v 0 0\n") == "a.obj:1:6: ends before z");
    CHECK(error_of_file("a.obj", "# \u00e9\nv \u00e9 0 0\n") == "a.obj:2:3: x is \"\u00e9\"" + not_a_number);
    CHECK(error_of_file("a.obj", three) == "a.obj: has no faces; a mesh has at least one triangle");
    CHECK(error_of_file("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
              .starts_with("a.obj: none of its faces has an area"));
    CHECK(error_of_file("a.obj", std::string(2 << 20, 'x')) ==
          "a.obj:1:1: is longer than 1 MB; write one vertex or face on each line");
    CHECK(error_of_file("a.fbx", "") ==
          "a.fbx: is not a known kind of mesh; its name must end in .obj, .ply, .stl, .gltf or .glb");

    const Mesh ball = scene::triangle::make_icosphere(0, {0, 0, 0}, 1);
    const std::string stl = to_stl_bytes(ball), ply = to_ply_bytes<float>(ball, false);
    CHECK(error_of_file("a.stl", "x" + stl.substr(1, 500)) ==
          "a.stl: byte 80: is not an STL: it does not begin with the word solid, and with 20 facets it would have 1084 "
          "bytes and not 501; was it cut short?");
    CHECK(error_of_file("a.ply", ply.substr(0, 500)) ==
          "a.ply: byte 499: ends before all elements are there; was it cut short?");
    CHECK(error_of_file("a.ply", ply.substr(0, 300)) ==
          "a.ply: byte 256: ends before the 12 elements of vertex, which take at least 156 bytes; was it cut short?");
    const std::string other_order = replace_text(ply, "little", "big");
    CHECK(has(error_of_file("a.ply", other_order), "is the byte order the one that the format line says?"));
}

TEST_CASE("a PLY may have lists that are not corners, in text and in bytes", "[mesh]") {
    const auto header = [](const std::string& kind) {
        return "ply\nformat " + kind +
               " 1.0\nelement vertex 3\nproperty list uchar uchar tags\nproperty uchar x\nproperty uchar y\n"
               "property uchar z\nelement strip 1\nproperty list uchar uchar w\nelement face 1\n"
               "property list uchar uchar uv\nproperty list uchar uchar vertex_indices\nend_header\n";
    };
    const Scratch folder;
    const Mesh text =
        read_mesh_file(folder.write("a.ply", header("ascii") + "0 0 0 1\n2 7 8 2 0 0\n1 9 0 3 0\n0\n1 5 3 2 0 1\n"));
    REQUIRE(text.faces.size() == 1);
    CHECK(text.vertices == std::vector<Vec<double>>{{0, 0, 1}, {2, 0, 0}, {0, 3, 0}});
    CHECK(text.faces[0] == scene::triangle::Face{2, 0, 1});
    const char numbers[] = {0, 0, 0, 1, 2, 7, 8, 2, 0, 0, 1, 9, 0, 3, 0, 0, 1, 5, 3, 2, 0, 1};
    const Mesh bytes =
        read_mesh_file(folder.write("b.ply", header("binary_big_endian") + std::string(numbers, sizeof numbers)));
    CHECK(are_same(bytes, text));
    CHECK(error_of_file("a.ply", replace_text(header("ascii"), "uchar x", "list uchar uchar x")) ==
          "a.ply:5:27: x of a vertex is a list; it must be one number");
    CHECK(error_of_file("a.ply", replace_text(header("ascii"), "list uchar uchar vertex", "uchar vertex")) ==
          "a.ply:12:16: vertex_indices of a face is one number; it must be a list");
}

TEST_CASE("text that would hide a line or a face is refused", "[mesh]") {
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", face = three + "f 1 2 3\n";
    CHECK(error_of_file("a.obj", face + std::string("\0f 1 3 2\n", 10)) ==
          "a.obj:5:1: has a zero byte; is it a text file?");
    CHECK(error_of_file("a.obj", face + std::string("f 1 3\0 2\n", 9)) ==
          "a.obj:5:6: has a zero byte; is it a text file?");
    CHECK(error_of_file("a.obj", face + "# a\rf 1 3 2\n") ==
          "a.obj:5:4: has a carriage return inside the line; end lines with line feeds");
    CHECK(error_of_file("a.obj", face + "\xEF\xBB\xBF"
                                        "f 1 3 2\n")
              .starts_with("a.obj:5:1: "));
    CHECK(has(error_of_file("a.obj", face + "F 1 3 2\n"), "a.obj:5:1: \"F\" is not a keyword of OBJ"));
    CHECK(error_of_file("a.obj", "\xEF\xBB\xBF# a mesh\r\n" + face + "usemtl red\nvn 0 0 1\n\n#comment\n") ==
          "no error");

    const auto stl = [](const std::string& facets) { return error_of_file("a.stl", "solid a\n" + facets); };
    const std::string corners = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n",
                      facet = corners + "endloop\nendfacet\n";
    CHECK(stl(facet + "endsolid a\n") == "no error");
    CHECK(stl(facet) == "a.stl:8:1: ends before endsolid; was it cut short?");
    CHECK(stl(facet + corners) == "a.stl:13:1: ends inside of a facet; was it cut short?");
    CHECK(stl(facet + "facet normal 0 0 1\nouter loop\nvertex 0 0 0\n") ==
          "a.stl:11:1: ends inside of a facet; was it cut short?");
    CHECK(stl(corners + "facet normal 0 0 1\n") == "a.stl:7:1: is not allowed inside of a facet, which endfacet ends");
    CHECK(stl(facet + "vertex 0 0 0\n") == "a.stl:9:1: is not allowed in a solid, outside of its facets");
    CHECK(stl(facet + "verte 0 0 0\n") == "a.stl:9:1: \"verte\" is not a keyword of STL; is it an STL?");

    const auto ply = [](const std::string& header, const std::string& body) {
        return error_of_file("a.ply", "ply\nformat ascii 1.0\n" + header + "end_header\n" + body);
    };
    const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
                      faces = "element face 1\nproperty list uchar float vertex_indices\n",
                      all = "0 0 0\n1 0 0\n0 1 0\n";
    CHECK(ply(vertices + faces, all + "3 0 1 2\n") == "no error");
    CHECK(ply(vertices + faces, all + "3 0 1.5 2\n") ==
          "a.ply:13:5: names vertex 1.5 of 3; vertices are whole numbers, and count from 0");
    CHECK(ply(vertices + faces, all + "3 0 nan 2\n").starts_with("a.ply:13:5: names vertex nan of 3"));
    CHECK(ply(vertices + faces, all + "3 0 1e30 2\n")
              .starts_with("a.ply:13:5: names vertex 1.0000000150474662e+30 of 3"));
    CHECK(ply(vertices + replace_text(faces, "uchar", "float"), all + "2.5 0 1 2\n") ==
          "a.ply:13:1: the length of vertex_indices is 2.5; it must be a whole number up to a million");
    CHECK(ply(vertices + faces, all + "3 0 1 2 1\n") ==
          "a.ply:13:9: is one value too many: the header lists no more properties of this element");
    CHECK(ply(vertices + faces, all + "3 0 1 2\n\n3 0 2 1\n") ==
          "a.ply:15:1: follows the last element that the header names");
    CHECK(ply(vertices + "elemnt face 1\n", all).starts_with("a.ply:7:1: \"elemnt\" is not a keyword of a PLY header"));
    CHECK(ply(vertices + vertices, all).starts_with("a.ply:7:9: a second element \"vertex\""));
    CHECK(ply(vertices + "property float x\n", all).starts_with("a.ply:7:16: a second property \"x\""));
    CHECK(ply(vertices + faces + "property list uchar int vertex_index\n", all)
              .starts_with("a.ply:9:25: a second list of the corners"));
    CHECK(error_of_file("a.ply", "ply\n" + vertices + faces + "end_header\n" + all + "3 0 1 2\n")
              .starts_with("a.ply:8:1: the header has no format line"));
    CHECK(error_of_file("a.ply", "") == "a.ply:1:1: is not a PLY: its first line is not ply");
    CHECK(error_of_file("a.ply", "plx\n") == "a.ply:1:1: is not a PLY: its first line is not ply");
    const std::string bytes = to_ply_bytes<float>(scene::triangle::make_icosphere(0, {0, 0, 0}, 1), false);
    CHECK(has(error_of_file("a.ply", bytes + "abc"), ": 3 bytes follow the last element that the header names"));
}

TEST_CASE("a byte order mark is skipped", "[mesh]") {
    const Scratch folder;
    const Mesh ball = scene::triangle::make_icosphere(1, {0, 0, 0}, 1);
    const std::string mark = "\xEF\xBB\xBF";
    folder.write("ball.bin", buffer_of_gltf(ball));
    for (const auto& [name, text] :
         {std::pair{"a.obj", to_obj(ball)}, std::pair{"a.ply", to_ply_text<double>(ball)},
          std::pair{"a.stl", to_stl_text(ball)}, std::pair{"a.gltf", to_gltf(ball, R"(, "uri": "ball.bin")")}}) {
        INFO(name);
        const Mesh plain = read_mesh_file(folder.write(name, text));
        CHECK(are_same(read_mesh_file(folder.write(std::string("marked-") + name, mark + text)), plain));
    }
}

TEST_CASE("a number too small for its type is rounded as any other", "[mesh]") {
    const Scratch folder;
    const auto first_of = [&](const std::string& number) {
        return read_mesh_file(folder.write("a.obj", "v 7 7 " + number + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"))
            .triangle(0)
            .a.z;
    };
    CHECK(first_of("1e-400") == 0);
    CHECK(std::signbit(first_of("-1e-400")));
    CHECK(first_of("+1e-400") == 0);
    CHECK(first_of("2.4703282292062328e-324") == 0x1p-1074);  // above half of it
    CHECK(first_of("2.4703282292062327e-324") == 0);
    CHECK(first_of("1e-310") == 1e-310);
    CHECK(first_of("0." + std::string(400, '0') + "1") == 0);
    std::string text = to_ply_text<float>(scene::triangle::make_icosphere(0, {0, 0, 0}, 1));
    text = replace_text(text, "255 0 ", "255 1e-60 ");
    CHECK(error_of_file("a.ply", text) == "no error");
    CHECK(has(error_of_file("a.ply", replace_text(text, "1e-60", "1e60")), "x is \"1e60\", which overflows"));
}

TEST_CASE("a vertex that the scene cannot hold is refused with its position in the file", "[mesh]") {
    const Scratch folder;
    Mesh vast = scene::triangle::make_fan(4, {0, 0, 0}, 1);
    vast.vertices[2].y = 0x1.ffffffp127;  // half an ulp above the largest: binary32 rounds it to infinity
    const auto error_with = [&](const FloatFormat& stored, const std::string& name, const std::string& bytes) {
        const auto path = folder.write(name, bytes);
        return error_in(folder, [&] { read_mesh_file(path, {.stop = {}, .vertex_format = stored}); });
    };
    const std::string says =
        "overflows binary32, to which inputs = \"shared\" rounds; scale the mesh, or write inputs = "
        "\"own\"";
    CHECK(error_with(binary64, "a.obj", to_obj(vast)) == "no error");
    CHECK(has(error_with(binary32, "a.obj", to_obj(vast)), says));
    CHECK(
        error_with(binary32, "a.obj", to_obj(vast)).starts_with("a.obj:5:5: y is \"3.4028235677973366e+38\", which "));
    CHECK(has(error_with(binary32, "a.ply", to_ply_text<double>(vast)), says));
    CHECK(has(error_with(binary32, "a.ply", to_ply_bytes<double>(vast, true)), says));
    CHECK(has(error_with(binary32, "a.stl", to_stl_text(vast)), says));
    vast.vertices[2].y = 0x1.fffffep127;
    for (const auto& [name, bytes] :
         {std::pair{"a.obj", to_obj(vast)}, std::pair{"a.ply", to_ply_bytes<double>(vast, true)},
          std::pair{"a.stl", to_stl_text(vast)}})
        CHECK(error_with(binary32, name, bytes) == "no error");
}

TEST_CASE("truncated or corrupted mesh files are read or refused without a crash", "[mesh]") {
    const Mesh ball = scene::triangle::make_icosphere(1, {0, 0, 0}, 1);
    const Scratch folder;
    lostbits::test::Random random(5);
    std::size_t refused = 0;
    const std::pair<const char*, std::string> files[] = {
        {"a.obj", to_obj(ball)},       {"b.ply", to_ply_text<double>(ball)}, {"c.ply", to_ply_bytes<float>(ball, true)},
        {"d.stl", to_stl_bytes(ball)}, {"e.stl", to_stl_text(ball)},         {"f.glb", to_glb(ball)}};
    for (const auto& [name, whole] : files) {
        for (int i = 0; i < lostbits::test::draws(300); ++i) {
            std::string bytes = whole;
            const auto place = static_cast<std::size_t>(random.between(0, static_cast<long>(bytes.size()) - 1));
            if (i % 3 == 0) bytes.resize(place);
            else bytes[place] = static_cast<char>(bytes[place] ^ (1 << random.between(0, 7)));
            const std::string error = error_of([&] { read_mesh_file(folder.write(name, bytes)); });
            INFO(name << ", change " << i << ": " << error);
            CHECK(error.find("another error") == std::string::npos);
            refused += error != "no error";
        }
    }
    CHECK(refused > static_cast<std::size_t>(lostbits::test::draws(300)));
}

}  // namespace test_mesh_file
