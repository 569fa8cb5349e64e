// Random text, hostile text among it, through the escaping of each kind of output and back through a reader of it.
#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <random>

#include "catch.hpp"
#include "extract_code.hpp"
#include "measure/answer/one_ray.hpp"
#include "measure/attribution/explanation.hpp"
#include "measure/rows.hpp"
#include "measure/tape/tape_form.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/file/csv.hpp"
#include "output/file/escape.hpp"
#include "output/file/read_csv.hpp"
#include "output/helpers.hpp"
#include "output/repair/form_code.hpp"
#include "output/report/text.hpp"
#include "scene/toml/toml_tree.hpp"
#include "text/shell_word.hpp"

namespace test_escape {

using namespace lostbits;
using namespace lostbits::output::file;
using output::test::Scratch;

namespace {

std::string utf8(char32_t c) {
    const auto tail = [&](int shift) { return static_cast<char>(0x80U | ((c >> shift) & 0x3FU)); };
    if (c < 0x80) return {static_cast<char>(c)};
    if (c < 0x800) return {static_cast<char>(0xC0U | (c >> 6)), tail(0)};
    if (c < 0x10000) return {static_cast<char>(0xE0U | (c >> 12)), tail(6), tail(0)};
    return {static_cast<char>(0xF0U | (c >> 18)), tail(12), tail(6), tail(0)};
}

std::vector<char32_t> code_points(const std::string& text) {
    std::vector<char32_t> all;
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i]);
        const std::size_t size = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
        char32_t c = size == 1 ? lead : lead & (0xFFU >> (size + 1));
        for (std::size_t k = 1; k < size; ++k) c = c << 6 | (static_cast<unsigned char>(text.at(i + k)) & 0x3FU);
        all.push_back(c);
        i += size;
    }
    return all;
}

/// Bytes, characters and pieces that some reader interprets, in random order.
std::string random_text(std::mt19937& random) {
    static const std::vector<std::string> pieces = [] {
        std::vector<std::string> all{"::error file=x,line=1::", "\xC2\xA0", "\n", "\r\n", "\r", "\t", " ", "\x1b[31m"};
        for (const char* more : {"\x1b]0;x\x07", "\xC2\x9B", "\xE2\x80\xAE", "\xEF\xBF\xBF", "\xEF\xBF\xBE", "\xFF",
                                 "\xC3", "\xED\xA0\x80", "?\?/"})
            all.emplace_back(more);
        std::istringstream words(
            R"(::error:: ##[error] %0A %25 % < </td> <script> <!-- --> ]]> & &amp; &#1; " ' \ \| | `
            `` [x](y) ![ * */ /* =1+1 @SUM(A1) -cmd|'/c'!A0 +1 -0x1p+3 , "" $(id) ; ~ a word 0)");
        for (std::string each; words >> each;) all.push_back(each);
        return all;
    }();
    std::string text;
    for (int n = std::uniform_int_distribution<int>(0, 9)(random); n > 0; --n) {
        const int kind = std::uniform_int_distribution<int>(0, 9)(random);
        if (kind < 6) text += pieces[std::uniform_int_distribution<std::size_t>(0, pieces.size() - 1)(random)];
        else if (kind < 8) text += static_cast<char>(std::uniform_int_distribution<int>(1, 255)(random));
        else text += utf8(std::uniform_int_distribution<char32_t>(1, 0x10FFFF)(random));
    }
    return text;
}

/// Calls `check` with many texts.
template <class Check>
void for_texts(int count, const Check& check) {
    std::mt19937 random(5);
    for (int i = 0; i < count; ++i) {
        const std::string text = random_text(random);
        INFO("text " << i << ": " << nlohmann::json(to_valid_utf8(text)).dump(-1, ' ', true));
        check(text);
    }
}

/// True for a character of XML 1.0 that is not a control, does not turn text around and does not end a line.
bool is_showable(char32_t c) {
    const bool of_xml =
        c == '\t' || c == '\n' || (c >= 0x20 && c < 0xD800) || (c >= 0xE000 && c < 0xFFFE) || c >= 0x10000;
    const bool turns = c == 0x61C || c == 0x200E || c == 0x200F || (c >= 0x202A && c <= 0x202E) ||
                       (c >= 0x2066 && c <= 0x2069) || c == 0x2028 || c == 0x2029;
    return of_xml && !(c >= 0x7F && c < 0xA0) && !turns;
}

constexpr int many = 20000;

/// Reads escape codes such as `%25` back, as GitHub's runner does.
std::string unescape(std::string text, const std::vector<std::pair<std::string, std::string>>& codes) {
    for (const auto& [code, meaning] : codes) {
        for (std::size_t at = 0; (at = text.find(code, at)) != std::string::npos; at += meaning.size())
            text.replace(at, code.size(), meaning);
    }
    return text;
}

/// Pipes that end a cell, as GitHub's Markdown counts them: a backslash takes the next character with it.
int cell_ends(const std::string& row) {
    int ends = 0;
    for (std::size_t i = 0; i < row.size(); ++i) {
        if (row[i] == '\\') ++i;
        else ends += row[i] == '|';
    }
    return ends;
}

/// True if Markdown sees a tag, or brackets of a link.
bool has_markup(const std::string& line) {
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '\\') ++i;
        else if (line[i] == '[' || line[i] == ']') return true;
        else if (line[i] == '<' && i + 1 < line.size() &&
                 (std::isalpha(static_cast<unsigned char>(line[i + 1])) != 0 ||
                  std::string("/!?").find(line[i + 1]) != std::string::npos))
            return true;
    }
    return false;
}

}  // namespace

TEST_CASE("escaped text never controls a terminal or a job's log", "[escape]") {
    for_texts(many, [](const std::string& text) {
        const std::string line = terminal_line(text), lines = terminal_text(text);
        REQUIRE(to_valid_utf8(line) == line);
        for (const char32_t c : code_points(line)) {
            REQUIRE(c >= 0x20);
            REQUIRE_FALSE((c >= 0x7F && c < 0xA0));
            REQUIRE_FALSE((c >= 0x202A && c <= 0x202E));
            REQUIRE_FALSE((c == 0x2028 || c == 0x2029 || c == 0xFFFE || c == 0xFFFF));
        }
        std::istringstream in(lines);
        for (std::string each; std::getline(in, each);) {
            const auto first = each.find_first_not_of(" \t\xC2\xA0");
            REQUIRE_FALSE((first != std::string::npos && each.substr(first).starts_with("::")));
            REQUIRE(each.find("##[") == std::string::npos);
            REQUIRE(each.find_first_of("\r\x1b\x07\x7f") == std::string::npos);
        }
        REQUIRE(line.find("##[") == std::string::npos);
        const auto first = line.find_first_not_of(' ');
        REQUIRE_FALSE((first != std::string::npos && line.substr(first).starts_with("::")));
    });
    CHECK(terminal_line("sphere (|f| − r) ü 日本") == "sphere (|f| − r) ü 日本");
    CHECK(terminal_text("a\n\tb") == "a\n\tb");
    CHECK(terminal_line("a\x1b[31m\n::x") == "a\\x1b[31m\\n\\x3a:x");
    CHECK(terminal_text("a\n ::error::x") == "a\n \\x3a:error::x");
}

TEST_CASE("every XML file that is written can be parsed back to the same text", "[escape]") {
    for_texts(many, [](const std::string& text) {
        const std::string safe = xml_text(text);
        pugi::xml_document written;
        auto node = written.append_child("a");
        node.append_attribute("b") = safe.c_str();
        node.text().set(("x" + safe + "x").c_str());
        std::ostringstream out;
        written.save(out, "");
        for (const char32_t c : code_points(out.str())) REQUIRE(is_showable(c));
        // A number in `&#…;` is a character too, and the same rule holds.
        for (std::size_t at = 0; (at = out.str().find("&#", at)) != std::string::npos; ++at) {
            const int code = std::stoi(out.str().substr(at + 2));
            REQUIRE((code == 9 || code == 10 || code >= 32));
        }
        pugi::xml_document read;
        REQUIRE(read.load_string(out.str().c_str()));
        REQUIRE(read.child("a").attribute("b").value() == safe);
        REQUIRE(read.child("a").text().get() == "x" + safe + "x");
    });
    CHECK(xml_text("a\u0085\u009b\u202Eb\u2066c") == "a\uFFFD\uFFFD\uFFFDb\uFFFDc");
    CHECK(xml_text("a\xEF\xBF\xBF\x01z\r\n") == "a\xEF\xBF\xBD\xEF\xBF\xBDz\n");
}

TEST_CASE("escaped text in HTML is plain text", "[escape]") {
    for_texts(many, [](const std::string& text) {
        const std::string page = output::report::html(text);
        REQUIRE(page.find_first_of("<>\"") == std::string::npos);
        REQUIRE(unescape(page, {{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}}) == xml_text(text));
    });
}

TEST_CASE("text in JSON reads back, and cannot end a script element", "[escape]") {
    for_texts(many, [](const std::string& text) {
        const std::string json = output::report::compact_json(output::report::Json(text));
        REQUIRE(json.find('<') == std::string::npos);
        REQUIRE(to_valid_utf8(nlohmann::json::parse(json).get<std::string>()).size() >= text.size() / 4);
        if (to_valid_utf8(text) == text) REQUIRE(nlohmann::json::parse(json) == text);
    });
}

TEST_CASE("text in Markdown stays in its cell and is not markup", "[escape]") {
    for_texts(many, [](const std::string& text) {
        const std::string inside = markdown_text(text), code = markdown_code(text);
        REQUIRE(inside.find_first_of("\r\n") == std::string::npos);
        REQUIRE(code.find_first_of("\r\n") == std::string::npos);
        REQUIRE(cell_ends("| " + inside + " | " + code + " |") == 3);
        REQUIRE_FALSE(has_markup(inside));
        REQUIRE(std::ranges::all_of(code_points(inside + code), is_showable));
        const std::string fence = code.substr(0, code.find_first_not_of('`'));
        REQUIRE(code.find(fence, fence.size()) == code.size() - fence.size());
        REQUIRE(markdown_path(text).find_first_of("() <>[]\\\"'|\r\n\t") == std::string::npos);
    });
    // Ordinary text is left as it is.
    for (const char* text : {"disc < 0 lets *every* NaN through", "`l² <= r²`, t* and 2^24", "f·f - r² > 1e-3"})
        CHECK(markdown_text(text) == text);
    CHECK(markdown_text("(|f| - r)") == "(\\|f\\| - r)");
    CHECK(markdown_text("a && b, a & b; &lt; &#60; &") == "a && b, a & b; \\&lt; \\&#60; &");
    CHECK(markdown_text("a\u202Eb") == "a\uFFFDb");
    CHECK(markdown_code("a|b") == "`a\\|b`");
    CHECK(markdown_path("pictures/a-b_0.5.png") == "pictures/a-b_0.5.png");
}

TEST_CASE("GitHub's runner reads a command's text back and no other command", "[escape]") {
    for_texts(many, [](const std::string& text) {
        const std::string data = workflow_text(text), value = workflow_value(text);
        REQUIRE(data.find_first_of("\r\n") == std::string::npos);
        REQUIRE(data.find("##[") == std::string::npos);
        REQUIRE(value.find_first_of("\r\n:,") == std::string::npos);
        REQUIRE(unescape(data, {{"%0D", "\r"}, {"%0A", "\n"}, {"%25", "%"}}) == terminal_text(text));
        REQUIRE(unescape(value, {{"%0D", "\r"}, {"%0A", "\n"}, {"%3A", ":"}, {"%2C", ","}, {"%25", "%"}}) ==
                terminal_text(text));
    });
}

TEST_CASE("a cell of a table reads back, and no spreadsheet evaluates it", "[escape]") {
    const Scratch folder;
    std::mt19937 random(6);
    std::vector<std::string> texts;
    for (int i = 0; i < many; ++i) texts.push_back(random_text(random));
    CsvWriter csv(folder / "t.csv", {{"text", "string", "", "-"}, {"n", "integer", "", "-"}});
    for (const std::string& text : texts) csv.add_row({text, 1});
    csv.close();
    const CsvTable table = read_csv(folder / "t.csv");
    REQUIRE(table.rows() == texts.size());
    for (std::size_t i = 0; i < texts.size(); ++i) {
        const std::string cell(table.columns[0].cells[i]), valid = to_valid_utf8(texts[i]);
        INFO(i);
        REQUIRE((cell == valid || cell == "'" + valid));
        const bool obeyed = cell.size() > 1 && std::string("=+-@\t\r").find(cell[0]) != std::string::npos;
        const bool plain = cell.find_first_not_of("0123456789.^+-*/ ") == std::string::npos;
        if (obeyed && !plain) REQUIRE(read_cell(cell).kind == CellValue::Kind::number);
    }
    for (const char* text :
         {"-1.5", "+2", "-0x1.8p+3", "-inf", "+nan", "-", "a=b", "'", "-1e5", "-.5", "+2^127", "-1+2"})
        CHECK(escape_formula(text) == text);
    for (const char* text : {"=A1", "@x", "+a", "-a", "\tx", "-1+a", "=a", "-0x"})
        CHECK(escape_formula(text) == std::string("'") + text);
}

TEST_CASE("text cannot end a comment in C", "[escape]") {
    for_texts(many, [](const std::string& text) {
        const std::string comment = "/* " + c_comment(text) + ". */";
        REQUIRE(comment.find("*/") == comment.size() - 2);
        REQUIRE(comment.find("/*", 1) == std::string::npos);
        REQUIRE(comment.find_first_of("\r\n\\") == std::string::npos);
        REQUIRE(comment.find("??") == std::string::npos);
    });
}

TEST_CASE("a compiler reads back every string literal, with and without trigraphs, and no comment continues",
          "[escape]") {
    const Scratch folder;
    std::string source = "#include <stdio.h>\nint lines = 0;\nstatic const char* const texts[] = {\n", expected,
                counted;
    int texts = 0;
    for_texts(4000, [&](const std::string& text) {
        const std::string literal = c_string(text), comment = line_comment(text);
        REQUIRE(std::ranges::all_of(code_points(literal), is_showable));
        REQUIRE(comment.find_first_of("\r\n") == std::string::npos);
        REQUIRE(lostbits::test::extract_code("// " + comment + "\nx\n", lostbits::test::c_code) == "\nx\n");
        source += "// " + comment + "\n" + literal + ",\n";
        counted += "// " + comment + "\nlines++;\n";
        expected += text + '\0';
        ++texts;
    });
    source += "};\nint main(void) {\nunsigned i;\n" + counted + "for (i = 0; i < sizeof texts / sizeof *texts; ++i) " +
              "printf(\"%s%c\", texts[i], 0);\nreturn lines == " + std::to_string(texts) + " ? 0 : 1;\n}\n";
    std::ofstream(folder / "texts.c", std::ios::binary) << source;
    for (const char* compiler : {"cc -std=c99 -w", "c++ -std=c++20 -w -x c++"}) {
        const std::string program = (folder / "texts").string(), out = (folder / "out").string();
        INFO(compiler);
        REQUIRE(std::system((std::string(compiler) + " -O0 -o '" + program + "' '" + (folder / "texts.c").string() +
                             "' && '" + program + "' >'" + out + "'")
                                .c_str()) == 0);
        REQUIRE(read_file(out) == expected);
    }
    // Ordinary text can be copied from a comment.
    for (const char* text : {"lostbits mend 'a b\\c.toml' -i sphere.half_b", "a?\?/b", "x \\ y", "|f|² − r²"})
        CHECK(line_comment(text) == text);
    CHECK(line_comment("x\\") == "x\\.");
    CHECK(line_comment("x\\  ") == "x\\  .");
    CHECK(line_comment("a\nb") == "a b");
    CHECK(c_string("a\"b\\c\n?\?/\x01"
                   "2") == "\"a\\\"b\\\\c\\012?\\?/\\0012\"");
}

TEST_CASE("a TOML parser reads back every string", "[escape]") {
    const Scratch folder;
    std::string file;
    std::vector<std::string> texts;
    for_texts(many, [&](const std::string& text) {
        file += "t" + std::to_string(texts.size()) + " = " + toml_string(text) + "\n";
        texts.push_back(to_valid_utf8(text));
    });
    std::ofstream(folder / "t.toml", std::ios::binary) << file;
    const auto root = scene::toml::read_toml(folder / "t.toml");
    REQUIRE(root.entries.size() == texts.size());
    for (const auto& entry : root.entries) {
        INFO(entry.key);
        REQUIRE(entry.value.text == texts.at(std::stoul(entry.key.substr(1))));
    }
}

TEST_CASE("untrusted names of operations and texts of forms are plain text in all generated code", "[escape]") {
    static const std::vector<std::string> hostile{"\\pwned{}$%&#~^_",
                                                  "\"}; int pwned = 1; //",
                                                  "*/ int pwned; /*",
                                                  "\n#include \"pwned\"\n",
                                                  "x\\",
                                                  "x?\?/",  // and what follows

                                                  "\xE2\x80\xAE pwned",
                                                  "'; pwned; '",
                                                  ") (pwned",
                                                  "lostbits: name=pwned",
                                                  "named",
                                                  "class",
                                                  "$1 $2"};
    const auto& form = lostbits::test::form_named("sphere.half_b");
    const Format f32 = *find_format("f32");
    const scene::file::Scene scene = lostbits::test::load("near-benign");
    auto explained = measure::attribution::explain(form, f32, measure::answer::OneRay(scene, 6, 4));
    Tape made = measure::tape::record_tape(form, f32);
    const auto name_anew = [](Tape& tape, std::size_t first) {
        for (TapeNode& node : tape.nodes)
            if (!node.label.empty()) node.label = hostile[first++ % hostile.size()];
    };
    name_anew(explained.tape, 0);
    std::size_t keywords = 0;
    const auto no_code = [](const std::string& what, const std::string& text, const lostbits::test::Language& language,
                            std::size_t includes) {
        INFO(what << "\n" << text);
        const std::string code = lostbits::test::extract_code(text, language);
        // Names of variables are made of letters of labels; nothing else is.
        for (std::size_t at = 0; (at = code.find("pwned", at)) != std::string::npos; ++at)
            CHECK((at > 0 && code[at - 1] == '_'));
        CHECK(code.find("\xE2\x80\xAE") == std::string::npos);
        std::size_t found = 0;
        for (std::size_t at = 0; (at = code.find("#include", at)) != std::string::npos; ++at) ++found;
        CHECK(found == includes);
    };
    for (const std::string& words : hostile) {
        name_anew(made, static_cast<std::size_t>(&words - hostile.data()));
        const output::repair::FormTexts said{
            .name = "mended.f", .title = words, .source = words, .head_lines = {words, words}};
        const std::string header = output::repair::form_header(made, form, said);
        no_code("header", header, lostbits::test::c_code, 2);
        keywords += header.find("named(\"class\", ") != std::string::npos;
        CHECK(header.find(" class = ") == std::string::npos);
        const std::string shader = output::repair::shader_code(
            made, form, {.name = "f", .title = words, .source = words, .head_lines = {words}});
        no_code("shader", shader, lostbits::test::c_code, 0);
        std::size_t marks = 0;
        for (std::size_t at = 0; (at = shader.find("lostbits:", at)) != std::string::npos; ++at) ++marks;
        CHECK(marks == 2 + (words.starts_with("lostbits:") ? 1 : 0));  // in the title, which is in quotation marks
    }
    CHECK(keywords > 0);
    no_code("C", output::attribution::explain_c(explained), lostbits::test::c_code, 2);
    no_code("FPCore", output::attribution::explain_fpcore(explained), lostbits::test::fpcore_code, 0);
}

TEST_CASE("a shell reads back every quoted argument", "[escape]") {
    const Scratch folder;
    std::mt19937 random(7);
    std::string script = "printf '%s\\0'", expected;
    for (int i = 0; i < 2000; ++i) {
        const std::string text = random_text(random);
        script += " " + text::shell_word(text);
        expected += text + '\0';
    }
    std::ofstream(folder / "script", std::ios::binary) << script;
    const std::string command = "sh '" + (folder / "script").string() + "' >'" + (folder / "out").string() + "'";
    REQUIRE(std::system(command.c_str()) == 0);
    REQUIRE(read_file(folder / "out") == expected);
}

}  // namespace test_escape
