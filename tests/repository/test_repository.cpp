// The rules of the house, on the tree itself; and for each rule a snippet that breaks it and one that does not.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "catch.hpp"
#include "repository/rules.hpp"

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

SourceFile form(const std::string& body) { return {"src/intersect/sphere/snippet.hpp", body}; }

}  // namespace

TEST_CASE("includes point one way", "[repository]") {
    const auto files = read_tree({"src", "analysis"});
    REQUIRE(files.size() > 40);
    hold_everywhere(files, include_directions);
}

TEST_CASE("an include to the right is caught", "[repository]") {
    CHECK(include_directions({"src/number/x.hpp", "#include \"geometry/vec.hpp\"\n"}).size() == 1);
    CHECK(include_directions(
              {"src/intersect/table/table.cpp", "#include <cmath>\n#include \"measure/truth/truth.hpp\"\n"})
              .size() == 1);
    CHECK(include_directions({"src/intersect/sphere/x.hpp", "  #  include <scene/rays/camera.hpp>\n"}).size() == 1);
    CHECK(include_directions({"src/output/x.cpp", "#include \"analysis/main.hpp\"\n"}).size() == 1);
    CHECK(include_directions({"src/number/x.hpp", "#include \"../geometry/vec.hpp\"\n"}).size() == 1);
    CHECK(include_directions({"src/output/x.cpp", "#include \"csv.hpp\"\n"}).size() == 1);
    CHECK(include_directions({"src/extra/x.hpp", ""}).size() == 1);
    CHECK(
        include_directions({"src/measure/x.hpp",
                            "#include \"number/real.hpp\"\n#include \"measure/truth/truth.hpp\"\n#include <mpfr.h>\n"})
            .empty());
    CHECK(include_directions({"analysis/x.cpp", "#include \"output/file/csv.hpp\"\n#include \"commands.hpp\"\n"})
              .empty());
}

TEST_CASE("forms stand on number, geometry and intersect, and obey the rules of a formula", "[repository]") {
    const auto files = read_tree({"src/intersect"});
    const auto forms = std::count_if(files.begin(), files.end(), is_form);
    CHECK(forms >= 21);
    CHECK_FALSE(is_form(find(files, "src/intersect/sphere/roots.hpp")));
    hold_everywhere(files, form_includes);
    hold_everywhere(files, formula_rules);
}

TEST_CASE("a form that includes more is caught", "[repository]") {
    CHECK(form_includes(form("#include <cmath>\n")).size() == 1);
    CHECK(form_includes(form("#include \"scene/rays/camera.hpp\"\n")).size() == 1);
    CHECK(form_includes(form("#include \"roots.hpp\"\n")).size() == 1);
    CHECK(form_includes(form("#include \"intersect/sphere/roots.hpp\"\n#include \"number/concept.hpp\"\n")).empty());
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
    CHECK(where[0] == "src/intersect/sphere/snippet.hpp:3: libm by name: std::sqrt");
    for (const char* good :
         {"const T l = sqrt(a);", "// 0.5 * x and if (a < b), std::sqrt(x)?", "/* t = a ? b : c;\n 1e-3 */",
          ".source = \"eq. 6, section 7.2 (2004)?\",", "const T h = T(1) / T(2);", "if (!any_of(active)) break;",
          "if constexpr (Form::info.both) {}", "for (int i = 0; i < 64; ++i) {}", "const T t0 = a.x * T(10);"}) {
        INFO(good);
        CHECK(formula_rules(form(good)).empty());
    }
}

TEST_CASE("the catalogue and the form files agree", "[repository]") {
    const auto files = read_tree({"src/intersect"});
    const Offences offences = catalogue_agrees(files, find(files, "src/intersect/catalogue.hpp"));
    INFO(listing(offences));
    CHECK(offences.empty());
}

TEST_CASE("a catalogue that disagrees is caught", "[repository]") {
    const SourceFile file{
        "src/intersect/sphere/thin_lens.hpp",
        "struct ThinLens {\n    static constexpr Info info{\n        .name = \"sphere.thin_lens\",\n"};
    const auto judge = [&](const std::string& text, const SourceFile& f) {
        return catalogue_agrees({f}, {"src/intersect/catalogue.hpp", text}).size();
    };
    const std::string include = "#include \"intersect/sphere/thin_lens.hpp\"\n",
                      entry = "using SphereForms = FormList<sphere::ThinLens>;\n";
    CHECK(judge(include + entry, file) == 0);
    CHECK(judge(entry, file) == 1);
    CHECK(judge(include, file) == 1);
    CHECK(judge(include + "// sphere::ThinLens\n", file) == 1);
    CHECK(judge(include + include + entry, file) == 1);
    CHECK(judge(include + entry + entry, file) == 1);
    CHECK(judge(include + "#include \"intersect/sphere/ghost.hpp\"\n" + entry, file) == 1);
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

TEST_CASE("no file has outgrown its page", "[repository]") {
    const auto files = read_tree({"src", "analysis", "tests"});
    hold_everywhere(files, file_length);
    const auto of_lines = [](int n) { return SourceFile{"src/x.cpp", std::string(static_cast<std::size_t>(n), '\n')}; };
    CHECK(file_length(of_lines(350)).empty());
    CHECK(file_length(of_lines(351)).size() == 1);
}

TEST_CASE("comments and strings are not code", "[repository]") {
    CHECK(code_of("a \"b\\\" c\" d") == "a \"     \" d");
    CHECK(code_of("a // b\nc") == "a     \nc");
    CHECK(code_of("a /* b\n c */ d") == "a     \n      d");
    CHECK(code_of("x = 'y'; 1'000") == "x = ' '; 1'000");
}

}  // namespace lostbits::test
