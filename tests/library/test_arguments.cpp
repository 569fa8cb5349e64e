// Every function of lostbits.h with each of its arguments wrong in turn: NULL, a count that exceeds memory, a
// meaningless text. A wrong argument must be answered with a sentence, and the caller's data must not change.
#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "catch.hpp"

namespace lostbits::test {
namespace test_arguments {
namespace {

constexpr const char* not_utf8 = "\xff\xfe\x80 \xc3";
const std::string vast(100000, 'x');

using Spoil = std::function<void(Arguments&)>;
struct Row {
    std::string what;
    std::vector<std::string> functions;  ///< that have the argument
    Spoil spoil;
    bool may_be_taken = false;  ///< what it says is nobody's business but the caller's
};

const std::vector<std::string> choosing{"map",   "judge", "answers", "sweep", "explain",
                                        "study", "trade", "choose",  "mend"},
    aiming{"judge", "answers", "truth", "hits"}, of_rays{"judge", "answers", "truth", "hits", "judge_mesh"},
    running{"map",        "judge", "answers", "truth", "hits",   "inside",
            "judge_mesh", "sweep", "study",   "trade", "choose", "mend"},
    opening{"scene_open", "scene_text"}, with_requirement{"choose", "mend"};

const std::vector<Row> null_rows{
    {"name", {"scene_open"}, [](Arguments& a) { a.name = nullptr; }},
    {"text", {"scene_text"}, [](Arguments& a) { a.text = nullptr; }},
    {"scene to make", opening, [](Arguments& a) { a.scene_out = nullptr; }},
    {"scene",
     {"scene_primitives", "scene_mesh", "scene_transform", "scene_rays", "map", "inside", "judge_mesh", "explain",
      "study", "choose", "mend"},
     [](Arguments& a) { a.scene = nullptr; }},
    {"shape", {"scene_primitives"}, [](Arguments& a) { a.shape = nullptr; }},
    {"numbers", {"scene_primitives"}, [](Arguments& a) { a.numbers = nullptr; }},
    {"vertices", {"scene_mesh"}, [](Arguments& a) { a.vertices = nullptr; }},
    {"faces", {"scene_mesh"}, [](Arguments& a) { a.faces = nullptr; }},
    {"matrix", {"scene_transform"}, [](Arguments& a) { a.matrix = nullptr; }},
    {"result to make",
     {"form_function", "scene_rays", "shapes", "map", "judge", "answers", "truth", "hits", "inside", "judge_mesh",
      "sweep", "explain", "study", "trade", "choose", "mend"},
     [](Arguments& a) { a.out = nullptr; }},
    {"forms", {"form_make"}, [](Arguments& a) { a.given_forms = nullptr; }},
    {"named", {"form_function"}, [](Arguments& a) { a.function = nullptr; }},
    {"form to make", {"form_make", "form_function"}, [](Arguments& a) { a.form_out = nullptr; }},
    {"form's name", {"form_make"}, [](Arguments& a) { a.forms[0].name = nullptr; }},
    {"form's run", {"form_make"}, [](Arguments& a) { a.forms[0].run = nullptr; }},
    {"form", {"form_write"}, [](Arguments& a) { a.form = nullptr; }},
    {"operations", {"form_write"}, [](Arguments& a) { a.operations = nullptr; }},
    {"op", {"form_write"}, [](Arguments& a) { a.listed[2].op = nullptr; }},
    {"rays", of_rays, [](Arguments& a) { a.given_rays = nullptr; }},
    {"answers about a mesh", {"judge_mesh"}, [](Arguments& a) { a.given_answers = nullptr; }},
    {"their column", {"judge_mesh"}, [](Arguments& a) { a.answers.column = nullptr; }},
    {"their values", {"judge_mesh"}, [](Arguments& a) { a.answers.values.data = nullptr; }},
    {"points", {"inside"}, [](Arguments& a) { a.given_rays = nullptr; }},
    {"points' numbers", {"inside"}, [](Arguments& a) { a.rays.origin.data = nullptr; }},
    {"origin", of_rays, [](Arguments& a) { a.rays.origin.data = nullptr; }},
    {"direction", of_rays, [](Arguments& a) { a.rays.direction.data = nullptr; }},
    {"rays' shape", aiming, [](Arguments& a) { a.rays.shape = nullptr; }},
    {"rays' primitives", aiming, [](Arguments& a) { a.rays.primitives.data = nullptr; }},
    {"sweep", {"sweep"}, [](Arguments& a) { a.sweep = nullptr; }},
    {"study", {"study"}, [](Arguments& a) { a.study = nullptr; }},
    {"requirement", with_requirement, [](Arguments& a) { a.given_requirement = nullptr; }},
    {"table to fill", {"result_table"}, [](Arguments& a) { a.into_table = nullptr; }},
    {"column to fill", {"result_column"}, [](Arguments& a) { a.into_column = nullptr; }},
    {"own with a count", choosing, [](Arguments& a) { a.choice.own_count = 1; }},
    {"a form of own", choosing, [](Arguments& a) { a.own = nullptr, a.choice.own = &a.own, a.choice.own_count = 1; }},
};

lostbits_words& set_of(Arguments& a) { return a.where.set; }
lostbits_words& forms_of(Arguments& a) { return a.choice.forms; }
lostbits_words& formats_of(Arguments& a) { return a.choice.formats; }
lostbits_words& metrics_of(Arguments& a) { return a.choice.metrics; }
lostbits_words& options_of(Arguments& a) { return a.options; }

/// A list of texts for C, and its owner.
struct List {
    std::string name;
    std::vector<std::string> functions;
    lostbits_words& (*list)(Arguments&);
};
const List lists[] = {{"set", opening, set_of},
                      {"forms", choosing, forms_of},
                      {"formats", choosing, formats_of},
                      {"metrics", choosing, metrics_of},
                      {"options", {"study"}, options_of}};
constexpr std::size_t all_bits = std::numeric_limits<std::size_t>::max();
constexpr std::size_t vast_counts[] = {all_bits, all_bits / 2, all_bits / 8 + 2, std::size_t{1} << 60};

std::vector<Row> list_rows() {
    std::vector<Row> rows;
    const auto add = [&rows](const List& list, const std::string& is, const char* text, std::size_t count) {
        rows.push_back({list.name + is, list.functions, [list = list.list, text, count](Arguments& a) {
                            a.spoilt = text;
                            list(a) = {&a.spoilt, count};
                        }});
    };
    for (const List& list : lists) {
        rows.push_back({list.name + " {NULL, 1}", list.functions, [&list](Arguments& a) {
                            list.list(a) = {nullptr, 1};
                        }});
        for (const std::size_t count : vast_counts) add(list, " of " + std::to_string(count), "*", count);
        for (const char* const text : {static_cast<const char*>(nullptr), not_utf8, "", vast.c_str()})
            add(list, " of " + std::string(text ? text : "NULL").substr(0, 20), text, 1);
    }
    return rows;
}

std::vector<Row> count_rows() {
    std::vector<Row> rows;
    for (const std::size_t n : vast_counts) {
        const std::string of = " of " + std::to_string(n);
        rows.push_back({"primitives" + of, {"scene_primitives"}, [n](Arguments& a) { a.primitive_count = n; }});
        rows.push_back({"vertices" + of, {"scene_mesh"}, [n](Arguments& a) { a.vertex_count = n; }});
        rows.push_back({"faces" + of, {"scene_mesh"}, [n](Arguments& a) { a.face_count = n; }});
        rows.push_back({"forms" + of, {"form_make"}, [n](Arguments& a) { a.form_count = n; }});
        rows.push_back({"operations" + of, {"form_write"}, [n](Arguments& a) { a.operation_count = n; }});
        rows.push_back({"own" + of, choosing, [n](Arguments& a) { a.choice.own = &a.own, a.choice.own_count = n; }});
        rows.push_back({"rays" + of, of_rays, [n](Arguments& a) { a.rays.count = n; }});
        rows.push_back({"points" + of, {"inside"}, [n](Arguments& a) { a.rays.count = n; }});
        rows.push_back({"rays of one" + of, aiming,
                        [n](Arguments& a) { a.rays.count = n, a.rays.origin.step = a.rays.direction.step = 0; }});
        rows.push_back({"rays' primitives" + of, aiming, [n](Arguments& a) { a.rays.primitive_count = n; }});
    }
    for (const std::ptrdiff_t n : {PTRDIFF_MAX, PTRDIFF_MIN, PTRDIFF_MAX / 2}) {
        rows.push_back({"step of values", {"judge_mesh"}, [n](Arguments& a) { a.answers.values.step = n; }});
        rows.push_back({"step", of_rays, [n](Arguments& a) { a.rays.origin.step = n; }});
        rows.push_back({"step of points", {"inside"}, [n](Arguments& a) { a.rays.origin.step = n; }});
        rows.push_back({"item_step", of_rays, [n](Arguments& a) { a.rays.direction.item_step = n; }});
        rows.push_back({"item_step of primitives", aiming, [n](Arguments& a) { a.rays.primitives.item_step = n; }});
    }
    rows.push_back({"no primitives", {"scene_primitives"}, [](Arguments& a) { a.primitive_count = 0; }});
    rows.push_back({"no faces", {"scene_mesh"}, [](Arguments& a) { a.face_count = 0; }});
    rows.push_back({"no vertices", {"scene_mesh"}, [](Arguments& a) { a.vertex_count = 0; }});
    rows.push_back({"no forms", {"form_make"}, [](Arguments& a) { a.form_count = 0; }});
    rows.push_back({"no operations", {"form_write"}, [](Arguments& a) { a.operation_count = 0; }});
    rows.push_back({"no primitives of rays", aiming, [](Arguments& a) { a.rays.primitive_count = 0; }});
    return rows;
}

std::vector<Row> text_rows() {
    std::vector<Row> rows;
    for (const char* const text : {not_utf8, "", vast.c_str(), "none such"}) {
        const std::string is = " is " + std::string(text).substr(0, 20);
        rows.push_back({"name" + is, {"scene_open"}, [text](Arguments& a) { a.name = text; }});
        rows.push_back({"text" + is, {"scene_text"}, [text](Arguments& a) { a.text = text; }});
        rows.push_back({"shape" + is, {"scene_primitives", "trade"}, [text](Arguments& a) { a.shape = text; }});
        rows.push_back({"form's name" + is,
                        {"form_make"},
                        [text](Arguments& a) { a.forms[0].name = text; },
                        std::string_view(text) == "none such"});
        rows.push_back({"form's title" + is, {"form_make"}, [text](Arguments& a) { a.forms[0].title = text; }, true});
        rows.push_back({"form's source" + is, {"form_make"}, [text](Arguments& a) { a.forms[0].source = text; }, true});
        rows.push_back({"op" + is, {"form_write"}, [text](Arguments& a) { a.listed[2].op = text; }});
        rows.push_back({"label" + is, {"form_write"}, [text](Arguments& a) { a.listed[2].label = text; }, true});
        rows.push_back({"rays' shape" + is, aiming, [text](Arguments& a) { a.rays.shape = text; }});
        rows.push_back({"column of answers" + is, {"judge_mesh"}, [text](Arguments& a) { a.answers.column = text; }});
        rows.push_back({"open_ends" + is, of_rays, [text](Arguments& a) { a.rays.open_ends = text; }});
        rows.push_back({"format" + is, of_rays, [text](Arguments& a) { a.rays.format = text; }});
        rows.push_back({"sweep" + is, {"sweep"}, [text](Arguments& a) { a.sweep = text; }});
        rows.push_back({"study" + is, {"study"}, [text](Arguments& a) { a.study = text; }});
        rows.push_back({"option" + is, {"study"}, [text](Arguments& a) { a.option = text; }});
        rows.push_back({"requirement at" + is, with_requirement, [text](Arguments& a) { a.requirement.at = text; }});
        // No folder named is the usual one.
        rows.push_back({"data" + is,
                        {"scene_open", "sweep"},
                        [text](Arguments& a) { a.data = a.where.data = text; },
                        *text == '\0'});
    }
    return rows;
}

std::vector<Row> number_rows() {
    std::vector<Row> rows;
    for (const int n : {INT_MIN, -1, INT_MAX}) {
        const std::string is = " is " + std::to_string(n);
        rows.push_back({"width" + is, opening, [n](Arguments& a) { a.where.width = n; }});
        rows.push_back({"height" + is, opening, [n](Arguments& a) { a.where.height = n; }});
        rows.push_back({"bits" + is, {"form_write"}, [n](Arguments& a) { a.bits = n; }});
        rows.push_back({"hit" + is, {"form_write"}, [n](Arguments& a) { a.hit = n; }});
        rows.push_back({"t" + is, {"form_write"}, [n](Arguments& a) { a.t = n; }});
        rows.push_back({"operand" + is, {"form_write"}, [n](Arguments& a) { a.listed[2].operands[1] = n; }});
        rows.push_back({"input" + is, {"form_write"}, [n](Arguments& a) { a.listed[0].operands[0] = n; }});
        rows.push_back({"x" + is, {"explain"}, [n](Arguments& a) { a.x = n; }});
        rows.push_back({"y" + is, {"explain"}, [n](Arguments& a) { a.y = n; }});
        rows.push_back({"bits of values" + is, {"judge_mesh"}, [n](Arguments& a) { a.answers.values.bits = n; }});
        rows.push_back({"bits of an array" + is, of_rays, [n](Arguments& a) { a.rays.origin.bits = n; }});
        rows.push_back({"bits of points" + is, {"inside"}, [n](Arguments& a) { a.rays.origin.bits = n; }});
        rows.push_back({"bits of primitives" + is, aiming, [n](Arguments& a) { a.rays.primitives.bits = n; }});
        rows.push_back({"form's shape" + is, {"form_make"}, [n](Arguments& a) { a.forms[0].shape = n; }});
        rows.push_back({"form's format" + is, {"form_make"}, [n](Arguments& a) { a.forms[0].format = n; }});
        rows.push_back({"form's direction" + is, {"form_make"}, [n](Arguments& a) { a.forms[0].direction = n; }});
        rows.push_back({"form's roots" + is, {"form_make"}, [n](Arguments& a) { a.forms[0].roots = n; }});
        rows.push_back({"form's touching" + is, {"form_make"}, [n](Arguments& a) { a.forms[0].touching = n; }});
        rows.push_back({"form's at_origin" + is, {"form_make"}, [n](Arguments& a) { a.forms[0].at_origin = n; }});
        rows.push_back(
            {"form's flags" + is, {"form_make"}, [n](Arguments& a) { a.forms[0].flags = static_cast<unsigned>(n); }});
        rows.push_back({"touching" + is, {"judge", "truth", "judge_mesh"}, [n](Arguments& a) { a.rays.touching = n; }});
        rows.push_back({"at_origin" + is, {"judge", "truth"}, [n](Arguments& a) { a.rays.at_origin = n; }});
        rows.push_back({"inside" + is, {"judge", "truth"}, [n](Arguments& a) { a.rays.inside = n; }});
        rows.push_back({"facing" + is, {"judge", "truth", "judge_mesh"}, [n](Arguments& a) { a.rays.facing = n; }});
        if (n < 0) rows.push_back({"threads" + is, running, [n](Arguments& a) { a.run.threads = n; }});
    }
    for (const double x : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
        const std::string is = " is " + std::to_string(x);
        rows.push_back({"a number" + is, {"scene_primitives"}, [x](Arguments& a) { a.sphere[1] = x; }});
        rows.push_back({"a vertex" + is, {"scene_mesh"}, [x](Arguments& a) { a.corners[1] = x; }});
        rows.push_back(
            {"a number of the matrix" + is, {"scene_transform"}, [x](Arguments& a) { a.matrix_numbers[1] = x; }});
        rows.push_back({"a number of values" + is, {"judge_mesh"}, [x](Arguments& a) { a.counts[1] = x; }});
        rows.push_back({"a number of a ray" + is, of_rays, [x](Arguments& a) { a.origins[4] = x; }});
        rows.push_back({"a number of a point" + is, {"inside"}, [x](Arguments& a) { a.origins[4] = x; }});
        rows.push_back({"a primitive of rays" + is, aiming, [x](Arguments& a) { a.sphere[1] = x; }});
        rows.push_back({"bits of a requirement" + is, with_requirement, [x](Arguments& a) { a.requirement.bits = x; }});
        rows.push_back(
            {"wrong of a requirement" + is, with_requirement, [x](Arguments& a) { a.requirement.wrong = x; }});
    }
    rows.push_back({"a tolerance that is not a number", with_requirement,
                    [](Arguments& a) { a.requirement.tolerance = std::nan(""); }});
    rows.push_back({"a face's place", {"scene_mesh"}, [](Arguments& a) { a.places[1] = UINT32_MAX; }});
    return rows;
}

bool is_utf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const std::size_t length = byte < 0x80   ? 1
                                   : byte < 0xc2 ? 0
                                   : byte < 0xe0 ? 2
                                   : byte < 0xf0 ? 3
                                   : byte < 0xf5 ? 4
                                                 : 0;
        if (length == 0 || i + length > text.size()) return false;
        for (std::size_t k = 1; k < length; ++k)
            if ((static_cast<unsigned char>(text[i + k]) & 0xc0) != 0x80) return false;
        i += length;
    }
    return true;
}

void check_rows(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
        for (const std::string& name : row.functions) {
            Arguments arguments;
            row.spoil(arguments);
            lostbits_error error{};
            const bool says = !name.starts_with("result_");
            INFO(name << ": " << row.what);
            const int code = function_named(name).call(arguments, &error);
            INFO(code << ": " << error.text);
            lostbits_result_free(arguments.new_result);
            lostbits_scene_free(arguments.new_scene);
            lostbits_form_free(arguments.new_form);
            if (row.may_be_taken && (code == LOSTBITS_OK || code == LOSTBITS_NO)) continue;
            CHECK((code == LOSTBITS_BAD_INPUT || code == LOSTBITS_NOTHING || code == LOSTBITS_ENVIRONMENT));
            CHECK(arguments.new_result == nullptr);
            CHECK(arguments.new_scene == nullptr);
            CHECK(arguments.new_form == nullptr);
            if (!says) continue;
            CHECK(error.code == code);
            CHECK(std::string_view(error.text) != "");
            if (row.what.find('\xff') == std::string::npos) CHECK(is_utf8(error.text));
            // The answer is the same for a caller that passes no place for the error.
            CHECK(function_named(name).call(arguments, nullptr) == code);
        }
    }
}

}  // namespace

TEST_CASE("every function of lostbits.h accepts right arguments, and NULL where it is allowed", "[library]") {
    for (const Function& function : functions) {
        INFO(function.name);
        for (const bool without : {false, true}) {
            Arguments arguments;
            if (without) arguments.at = nullptr, arguments.given_options = nullptr;
            if (without) arguments.requirement.at = nullptr;
            if (without && std::string_view(function.name) == "scene_open")
                arguments.name = LOSTBITS_DATA_DIR "/scenes/near-benign.toml";
            lostbits_error error{};
            const int code = function.call(arguments, &error);
            INFO(error.text);
            CHECK((code == LOSTBITS_OK || code == LOSTBITS_NO));
            lostbits_result_free(arguments.new_result);
            lostbits_scene_free(arguments.new_scene);
            lostbits_form_free(arguments.new_form);
        }
    }
}

TEST_CASE("every required pointer of lostbits.h is refused when it is NULL", "[library]") {
    check_rows(null_rows);
    lostbits_table table;
    lostbits_column column;
    CHECK(lostbits_result_table(nullptr, 0, &table) == LOSTBITS_NOTHING);
    CHECK(lostbits_result_column(nullptr, 0, 0, &column) == LOSTBITS_NOTHING);
    CHECK(lostbits_result_text(nullptr, 0) == nullptr);
    lostbits_result_free(nullptr);
    lostbits_scene_free(nullptr);
    lostbits_form_free(nullptr);
}
TEST_CASE("every list of texts of lostbits.h is checked against its count", "[library]") { check_rows(list_rows()); }
TEST_CASE("every count of lostbits.h that exceeds memory is refused", "[library]") { check_rows(count_rows()); }
TEST_CASE("every meaningless text is refused by lostbits.h", "[library]") { check_rows(text_rows()); }
TEST_CASE("every meaningless number is refused by lostbits.h", "[library]") { check_rows(number_rows()); }

TEST_CASE("every function of lostbits.h is covered by these tests", "[library]") {
    std::set<std::string> left_out{"abi",       "version",     "end_threads", "scene_free",
                                   "form_free", "result_text", "result_free"};
    FILE* const names = popen("nm -D --defined-only --format=posix '" LOSTBITS_LIBRARY "'", "r");
    REQUIRE(names != nullptr);
    char line[4096];
    while (std::fgets(line, sizeof line, names) != nullptr) {
        std::string name(line, std::string(line).find(' '));
        if (!name.starts_with("lostbits_")) continue;
        name.erase(0, 9);
        INFO(name);
        const bool is_tested =
            std::ranges::any_of(functions, [&](const Function& function) { return function.name == name; });
        CHECK(is_tested != left_out.contains(name));
    }
    CHECK(pclose(names) == 0);
}

}  // namespace test_arguments
}  // namespace lostbits::test
