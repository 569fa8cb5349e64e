// The rules of the house, on the tree itself; and for each rule a snippet that breaks it and one that does not.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "catch.hpp"
#include "repository/rooms.hpp"

namespace lostbits::test {
namespace {

namespace fs = std::filesystem;

std::vector<SourceFile> read_tree(const std::vector<std::string>& folders) {
    std::vector<SourceFile> files;
    const fs::path root(LOSTBITS_SOURCE_DIR);
    for (const std::string& folder : folders)
        for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
            const fs::path& path = entry.path();
            if (!entry.is_regular_file() ||
                (path.extension() != ".hpp" && path.extension() != ".cpp" && path.extension() != ".h"))
                continue;
            std::ostringstream text;
            text << std::ifstream(path, std::ios::binary).rdbuf();
            files.push_back({fs::relative(path, root).generic_string(), text.str()});
        }
    std::sort(files.begin(), files.end(), [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
    return files;
}

std::string text_of(const std::string& path) {
    std::ifstream in(fs::path(LOSTBITS_SOURCE_DIR) / path, std::ios::binary);
    REQUIRE(in);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

SourceFile find(const std::vector<SourceFile>& files, const std::string& path) {
    for (const SourceFile& file : files)
        if (file.path == path) return file;
    FAIL(path << " not found");
    return {};
}

std::string listing(const Offences& offences) {
    std::string text;
    for (const std::string& line : offences) text += "\n" + line;
    return text;
}

template <class Rule>
void hold_everywhere(const std::vector<SourceFile>& files, Rule rule) {
    Offences all;
    for (const SourceFile& file : files)
        for (std::string& line : rule(file)) all.push_back(std::move(line));
    INFO(listing(all));
    CHECK(all.empty());
}

SourceFile form(const std::string& body) { return {"src/shapes/sphere/forms/snippet.hpp", body}; }

}  // namespace

TEST_CASE("includes point one way, between layers and between rooms", "[repository]") {
    const auto rooms = rooms_in(text_of("src/README.md"));
    REQUIRE(rooms.size() > 30);
    const auto files = read_tree({"src", "analysis"});
    REQUIRE(files.size() > 300);
    hold_everywhere(files, [&](const SourceFile& file) { return include_directions(rooms, file); });
}

TEST_CASE("an include to the right is caught", "[repository]") {
    const auto judge = [rooms = rooms_in(text_of("src/README.md"))](const char* path, const char* text) {
        return include_directions(rooms, {path, text}).size();
    };
    CHECK(judge("src/number/x.hpp", "#include \"geometry/vec.hpp\"\n") == 1);
    CHECK(judge("src/intersect/table/table.cpp", "#include <cmath>\n#include \"measure/truth/truth.hpp\"\n") == 1);
    CHECK(judge("src/shapes/sphere/forms/x.hpp", "  #  include <scene/rays/camera.hpp>\n") == 1);
    CHECK(judge("src/measure/truth/x.cpp", "#include \"measure/metric/metrics.hpp\"\n") == 1);
    CHECK(judge("src/output/file/x.hpp", "#include \"output/plot/plot_axis.hpp\"\n") == 1);
    CHECK(judge("src/intersect/info.hpp", "#include \"shapes/sphere/forms/roots.hpp\"\n") == 1);
    CHECK(judge("src/output/map/x.cpp", "#include \"analysis/main.hpp\"\n") == 1);
    CHECK(judge("src/number/x.hpp", "#include \"../geometry/vec.hpp\"\n") == 1);
    CHECK(judge("src/output/file/x.cpp", "#include \"csv.hpp\"\n") == 1);
    CHECK(judge("src/measure/x.hpp", "") == 1);
    CHECK(judge("src/extra/x.hpp", "") == 1);
    CHECK(judge("src/measure/metric/x.hpp",
                "#include \"number/real.hpp\"\n#include \"measure/truth/truth.hpp\"\n#include <mpfr.h>\n") == 0);
    CHECK(judge("src/intersect/catalogue.hpp", "#include \"shapes/sphere/forms/press.hpp\"\n") == 0);
    CHECK(judge("analysis/x.cpp", "#include \"output/file/csv.hpp\"\n#include \"commands.hpp\"\n") == 0);
}

TEST_CASE("every room says what it is for, as the list of rooms does, and no room is too large", "[repository]") {
    const std::string readme = text_of("src/README.md");
    const auto rooms = rooms_in(readme);
    std::vector<std::string> found;
    for (const SourceFile& file : read_tree({"src"})) {
        const std::string room = file.path.substr(4, file.path.rfind('/') - 4);
        if (found.empty() || found.back() != room) found.push_back(room);
    }
    for (const std::string& room : std::set<std::string>(found.begin(), found.end())) {
        INFO(room);
        REQUIRE(std::ranges::find(rooms, room) != rooms.end());
        const std::string own = text_of("src/" + room + "/README.md");
        CHECK(std::ranges::count(own, '\n') == 1);
        const auto row = readme.find("| `" + room + "` | ") + room.size() + 7;
        const std::string purpose = readme.substr(row + 1, readme.find(" |\n", row) - row - 1);
        CHECK(own.substr(1, purpose.size()) == purpose);
    }
    const Offences crowded = room_sizes(read_tree({"src", "analysis"}));
    INFO(listing(crowded));
    CHECK(crowded.empty());
    CHECK(room_sizes(std::vector<SourceFile>(23, {"src/output/map/x.cpp", ""})).size() == 1);
    CHECK(room_sizes(std::vector<SourceFile>(22, {"src/output/map/x.cpp", ""})).empty());
    CHECK(room_sizes(std::vector<SourceFile>(99, {"src/shapes/sphere/forms/x.hpp", ""})).empty());
}

TEST_CASE("a room is a namespace", "[repository]") {
    hold_everywhere(read_tree({"src", "analysis"}), room_namespace);
    CHECK(room_namespace({"src/measure/evaluate/x.cpp", "namespace lostbits::measure::sweep {\n}\n"}).size() == 2);
    CHECK(room_namespace({"src/measure/evaluate/x.cpp", "namespace lostbits {\n}\n"}).size() == 2);
    CHECK(room_namespace({"src/measure/evaluate/x.cpp", "namespace lostbits::measure::evaluate {\n}\n"}).empty());
    CHECK(room_namespace({"src/geometry/x.hpp", "namespace lostbits {\n}\n"}).empty());
}

TEST_CASE("no two definitions share a name", "[repository]") {
    const auto files = read_tree({"src", "analysis"});
    std::size_t definitions = 0;
    for (const SourceFile& file : files) definitions += definitions_in(file).size();
    CHECK(definitions > 500);
    const Offences offences = names_are_unique(files);
    INFO(listing(offences));
    CHECK(offences.empty());
}

TEST_CASE("two definitions of one name are caught", "[repository]") {
    const auto judge = [](const std::string& a, const std::string& b) {
        return names_are_unique({{"src/measure/evaluate/a.hpp", a}, {"src/measure/sweep/b.hpp", b}}).size();
    };
    const std::string room = "namespace lostbits::measure {\n", other = "namespace lostbits::output {\n";
    const std::string type = "struct Standing {\n    int x;\n};\n";
    CHECK(judge(room + type + "}\n", room + type + "}\n") == 1);
    CHECK(judge(room + type + "}\n", other + type + "}\n") == 1);
    CHECK(judge(room + type + "}\n", other + "using Standing = int;\n}\n") == 1);
    CHECK(judge(room + type + "}\n", room + "enum class Standing : char { a, b };\n}\n") == 1);
    const std::string function = "inline int twice(int x) {\n    return 2 * x;\n}\n";
    CHECK(judge(room + function + "}\n", room + function + "}\n") == 1);
    CHECK(judge(room + function + "}\n", other + function + "}\n") == 0);
    CHECK(judge(room + type + "}\n", room + "namespace {\n" + type + "}\n}\n") == 0);
    CHECK(judge(room + type + "}\n", room + "struct Standing;\nstruct Place {\n    struct Standing {};\n};\n}\n") == 0);
    CHECK(judge(room + type + "}\n", room + "/* struct Standing {} */ void f() { struct Standing {}; }\n}\n") == 0);
}

TEST_CASE("forms stand on number, geometry, shapes and intersect, and obey the rules of a formula", "[repository]") {
    const auto files = read_tree({"src/intersect", "src/shapes"});
    const auto forms = std::count_if(files.begin(), files.end(), is_form);
    CHECK(forms >= 21);
    CHECK_FALSE(is_form(find(files, "src/shapes/sphere/forms/roots.hpp")));
    hold_everywhere(files, form_includes);
    hold_everywhere(files, formula_rules);
}

TEST_CASE("a form that includes more is caught", "[repository]") {
    CHECK(form_includes(form("#include <cmath>\n")).size() == 1);
    CHECK(form_includes(form("#include \"scene/rays/camera.hpp\"\n")).size() == 1);
    CHECK(form_includes(form("#include \"roots.hpp\"\n")).size() == 1);
    CHECK(form_includes(form("#include \"shapes/sphere/forms/roots.hpp\"\n#include \"number/concept.hpp\"\n")).empty());
    CHECK(form_includes({"src/intersect/table/table.cpp", "#include <array>\n"}).empty());
}

TEST_CASE("a formula that breaks a rule is caught", "[repository]") {
    for (const char* bad : {"const T l = std::sqrt(a);",
                            "const T e = std::fma(a, b, c);",
                            "const T e = std::abs(a);",
                            "T m = std::min(a, b);",
                            "T m = std::max<T>(a, b);",
                            "T m = ::sqrt(a);",
                            "T m = std::fabs(a);",
                            "T s = std::copysign(a, b);",
                            "const T h = T(0.5);",
                            "const T h = 1e-3 * x;",
                            "const T h = x * 2.0f;",
                            "const T h = .5 * x;",
                            "const T h = 4. * x;",
                            "const T h = T(0x1p-3);",
                            "if (disc < T(0)) return miss;",
                            "if(hit) t = far;",
                            "while (t < T(1)) {}",
                            "const T t = near < T(0) ? far : near;",
                            "double t = 0;",
                            "const float k(1);",
                            "std::numeric_limits<T>::epsilon();"}) {
        INFO(bad);
        CHECK(formula_rules(form(std::string("line one\n") + bad + "\n")).size() >= 1);
        CHECK(formula_rules({"src/intersect/table/table.cpp", bad}).empty());
    }
    const Offences where = formula_rules(form("// std::sqrt(x) is mentioned here\n\nconst T l = std::sqrt(a);\n"));
    REQUIRE(where.size() == 1);
    CHECK(where[0] == "src/shapes/sphere/forms/snippet.hpp:3: libm by name: std::sqrt");
    for (const char* good :
         {"const T l = sqrt(a);", "// 0.5 * x and if (a < b), std::sqrt(x)?", "/* t = a ? b : c;\n 1e-3 */",
          ".source = \"eq. 6, section 7.2 (2004)?\",", "const T h = T(1) / T(2);", "if (!any_of(active)) break;",
          "if constexpr (Form::info.both) {}", "for (int i = 0; i < 64; ++i) {}", "const T t0 = a.x * T(10);"}) {
        INFO(good);
        CHECK(formula_rules(form(good)).empty());
    }
}

TEST_CASE("no number is read as the locale says", "[repository]") {
    hold_everywhere(read_tree({"src", "analysis"}), locale_rules);
    for (const char* bad : {"double x = std::stod(text);", "x = strtod(a, &b);", "std::setlocale(LC_ALL, \"\");"}) {
        INFO(bad);
        CHECK(locale_rules({"src/x.cpp", bad}).size() == 1);
    }
    CHECK(locale_rules({"src/x.cpp", "// strtod() would read 0.5 as 0\nstd::from_chars(a, b, x);"}).empty());
}

namespace {

/// Lines that name a shape, in comments and texts too: as `Shape::` of the list has it, or by its struct.
std::ptrdiff_t names_of_shapes(const SourceFile& file) {
    static const std::regex line(R"(    line\(\w+, (\w+)\))");
    static const std::regex name([list = text_of("src/shapes/list.hpp")] {
        std::string names = "Shape::";
        for (auto m = std::sregex_iterator(list.begin(), list.end(), line); m != std::sregex_iterator(); ++m)
            names += "|" + (*m)[1].str() + "<";
        return names;
    }());
    std::istringstream lines(file.text);
    std::ptrdiff_t found = 0;
    for (std::string text; std::getline(lines, text);) found += std::regex_search(text, name);
    return found;
}

}  // namespace

TEST_CASE("what names a shape lies in its folder, or has its reason", "[repository]") {
    const std::string march = "a march is of all solids together, and has a word among the shapes";
    const std::map<std::string, std::string> reasons{
        {"analysis/selection/ray_words.cpp", march},
        {"analysis/selection/sets.hpp", march},
        {"analysis/judge.cpp", march},
        {"src/intersect/doors/formula_of.hpp", "what a compiler says to who writes a form: two examples and a march"},
        {"src/intersect/simd/packed_many_kernels.hpp", "the planes of a box in order: a loop by hand"},
        {"src/intersect/simd/plain_many_w256.cpp", "loops that others write over boxes"},
        {"src/intersect/takes.hpp", march},
        {"src/intersect/target.hpp", march},
        {"src/measure/picture/shade.hpp", "pictures are of spheres"},
        {"src/measure/picture/true_picture.cpp", "pictures are of spheres"},
        {"src/scene/file/appearance.hpp", "pictures are of spheres"},
        {"src/scene/file/scene.cpp", march},
        {"src/scene/sweep/sweep_file.hpp", march}};
    std::set<std::string> found;
    std::ptrdiff_t all = 0;
    for (const SourceFile& file : read_tree({"src", "analysis"})) {
        if (file.path.starts_with("src/shapes/") || names_of_shapes(file) == 0) continue;
        INFO(file.path);
        CHECK(reasons.contains(file.path));
        found.insert(file.path);
        all += names_of_shapes(file);
    }
    for (const auto& [path, reason] : reasons) {
        INFO(path);
        CHECK(found.contains(path));
    }
    INFO(all << " lines");
    CHECK(all <= 19);
    CHECK(names_of_shapes({"src/x.cpp", "if (solid.shape != Shape::box) return;\nconst Sphere<S> sphere;"}) == 2);
    CHECK(names_of_shapes({"src/x.cpp", "// of Cone<T>\nif (shape == Shape::sdf) return;\nShapes all;"}) == 2);
}

TEST_CASE("the catalogue and the form files agree", "[repository]") {
    const auto files = read_tree({"src/intersect", "src/shapes"});
    SourceFile catalogue = find(files, "src/intersect/catalogue.hpp");
    for (const SourceFile& file : files)
        if (file.path.ends_with("/forms/forms.hpp")) catalogue.text += file.text;
    const Offences offences = catalogue_agrees(files, catalogue);
    INFO(listing(offences));
    CHECK(offences.empty());
}

TEST_CASE("a catalogue that disagrees is caught", "[repository]") {
    const SourceFile file{
        "src/shapes/sphere/forms/thin_lens.hpp",
        "struct ThinLens {\n    static constexpr Info info{\n        .name = \"sphere.thin_lens\",\n"};
    const auto judge = [&](const std::string& text, const SourceFile& f) {
        return catalogue_agrees({f}, {"src/intersect/catalogue.hpp", text}).size();
    };
    const std::string include = "#include \"shapes/sphere/forms/thin_lens.hpp\"\n",
                      entry = "using SphereForms = FormList<sphere::ThinLens>;\n";
    CHECK(judge(include + entry, file) == 0);
    CHECK(judge(entry, file) == 1);
    CHECK(judge(include, file) == 1);
    CHECK(judge(include + "// sphere::ThinLens\n", file) == 1);
    CHECK(judge(include + include + entry, file) == 1);
    CHECK(judge(include + entry + entry, file) == 1);
    CHECK(judge(include + "#include \"shapes/sphere/forms/ghost.hpp\"\n" + entry, file) == 1);
    CHECK(judge(include + entry + "sphere::Ghost\n", file) == 1);
    SourceFile renamed = file;
    renamed.text.replace(renamed.text.find("sphere.thin_lens"), 16, "sphere.thick_len");
    CHECK(judge(include + entry, renamed) == 1);
}

TEST_CASE("one unit alone is let out of the ban on fast math", "[repository]") {
    std::vector<std::string> defining;
    for (const SourceFile& file : read_tree({"src", "analysis", "bench"}))
        if (file.text.find("#define LOSTBITS_MEASURES_FAST_MATH") != std::string::npos) defining.push_back(file.path);
    CHECK(defining == std::vector<std::string>{"src/intersect/simd/variant_fastmath.cpp"});
}

TEST_CASE("one file alone sees the parser of the command line", "[repository]") {
    std::vector<std::string> seeing;
    for (const SourceFile& file : read_tree({"src", "analysis"}))
        if (file.text.find("#include <CLI/") != std::string::npos) seeing.push_back(file.path);
    CHECK(seeing == std::vector<std::string>{"analysis/shell/command_line.cpp"});
}

TEST_CASE("no file has outgrown its page", "[repository]") {
    const auto files = read_tree({"src", "analysis", "tests"});
    hold_everywhere(files, file_length);
    const auto of_lines = [](int n) { return SourceFile{"src/x.cpp", std::string(static_cast<std::size_t>(n), '\n')}; };
    CHECK(file_length(of_lines(350)).empty());
    CHECK(file_length(of_lines(351)).size() == 1);
    CHECK(file_length({"src/x.cpp", std::string(121, 'x')}).size() == 1);
    CHECK(file_length({"src/x.cpp", "ü" + std::string(119, 'x')}).empty());
}

TEST_CASE("comments and strings are not code", "[repository]") {
    CHECK(code_of("a \"b\\\" c\" d") == "a \"     \" d");
    CHECK(code_of("a // b\nc") == "a     \nc");
    CHECK(code_of("a /* b\n c */ d") == "a     \n      d");
    CHECK(code_of("x = 'y'; 1'000") == "x = ' '; 1'000");
}

}  // namespace lostbits::test
