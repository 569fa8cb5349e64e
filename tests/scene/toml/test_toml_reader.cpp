// TOML values with their positions, and errors with advice.
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

#include "catch.hpp"
#include "number/real.hpp"
#include "scene/scene_text.hpp"
#include "scene/toml/toml_reader.hpp"
#include "text/did_you_mean.hpp"

namespace test_toml_reader {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::toml;
using namespace lostbits::scene::test;

namespace {

/// A parsed text that lives as long as its readers.
struct Text {
    explicit Text(const std::string& text) : root(read_toml(folder.write("t.toml", text))) {}
    [[nodiscard]] TableReader reader() const { return TableReader(root); }
    template <class Read>
    std::string error(Read read) const {
        return error_in(folder, [&] {
            TableReader table = reader();
            read(table);
        });
    }
    Scratch folder;
    Node root;
};

std::string file_error(const std::string& text) {
    const Scratch folder;
    const fs::path file = folder.write("t.toml", text);
    return error_in(folder, [&] { read_toml(file); });
}

std::string schema_error(const std::string& text) {
    return Text(text).error([](TableReader& table) { require_schema(table, "lostbits-scene/1"); });
}

enum class Fruit { apple, pear };
constexpr std::pair<std::string_view, Fruit> fruit[] = {{"apple", Fruit::apple}, {"pear", Fruit::pear}};

}  // namespace

TEST_CASE("a file that cannot be read is refused with the reason") {
    const Scratch folder;
    CHECK(error_in(folder, [&] { read_toml(folder.path() / "none.toml"); }) ==
          "none.toml: no such file; check its name and the current folder");
    CHECK(error_of([&] { read_toml(folder.path()); }) ==
          folder.path().string() + ": is a folder; name a .toml file in it");
    const fs::path large = folder.write("large.toml", std::string((16u << 20) + 1, '\n'));
    CHECK(error_in(folder, [&] { read_toml(large); }).starts_with("large.toml:1:1: is larger than 16 MiB"));
}

TEST_CASE("many numbers in one line are read in time proportional to their bytes") {
    // Two hundred thousand numbers: counting the characters before each takes a minute.
    std::string text = "x = [0.5";
    for (int i = 0; i < 200'000; ++i) text += i % 1000 == 0 ? ", 1.25" : ", 1.5";
    const Scratch folder;
    const Node file = read_toml(folder.write("t.toml", "# \u00e9\n" + text + ", 2.75] # \u00e9\n"));
    const Node& x = *file.find("x");
    REQUIRE(x.items.size() == 200'002);
    CHECK(x.items[1].text == "1.25");
    CHECK(x.items[2].text == "1.5");
    CHECK(x.items.back().text == "2.75");
    const Node mixed = read_toml(folder.write("u.toml", "a = { \"\u00e9\" = 0.125, \"b\u00e9\" = 0.25, c = 0.5 }\n"));
    CHECK(mixed.find("a")->find("c")->text == "0.5");
    CHECK(mixed.find("a")->find("b\u00e9")->text == "0.25");
}

TEST_CASE("reading from a silent pipe stops on request") {
    const Scratch folder;
    const auto path = (folder / "p.toml").string();
    REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
    std::atomic<bool> stop_requested{true};
    CHECK_THROWS_AS(read_toml(path, intersect::process::StopToken(stop_requested)), Interrupted);
    stop_requested = false;
    const int writer = ::open(path.c_str(), O_RDWR);  // opened for both, it does not block
    const std::string text = "a = 1\n";
    REQUIRE(::write(writer, text.data(), text.size()) == static_cast<ssize_t>(text.size()));
    // The signal comes while the reader waits for more: it wakes up, and the token says why.
    struct sigaction action {
    }, before{};
    action.sa_handler = [](int) {};
    sigaction(SIGUSR1, &action, &before);
    std::atomic<bool> over{false};
    const pthread_t reader = ::pthread_self();
    std::thread knocks([&] {
        for (int unread = 1; unread > 0; std::this_thread::yield()) ::ioctl(writer, FIONREAD, &unread);
        stop_requested = true;
        for (; !over; std::this_thread::sleep_for(std::chrono::milliseconds(5))) ::pthread_kill(reader, SIGUSR1);
    });
    CHECK_THROWS_AS(read_toml(path, intersect::process::StopToken(stop_requested)), Interrupted);
    over = true;
    knocks.join();
    sigaction(SIGUSR1, &before, nullptr);
    ::close(writer);
}

TEST_CASE("a name of an earlier version is read as today's name") {
    const Text file(
        "event = \"wrong_object\"\nnames = [\"wrong_object_fraction\", \"lost_bits\"]\n[family]\nviews = 2\n");
    TableReader table = file.reader();
    CHECK(table.table("sphere_rays").integer("views", 1, 3) == 2);
    CHECK(table.string("event") == "wrong_primitive");
    CHECK(table.strings("names") == std::vector<std::string>{"wrong_primitive_fraction", "lost_bits"});
}

TEST_CASE("a syntax error is reported with its line and column") {
    CHECK(file_error("a = 1\nb = = 2\n").starts_with("t.toml:2:5: not valid TOML: "));
    CHECK(file_error("a = 1\na = 2\n").starts_with("t.toml:2:"));
    CHECK(file_error("a = \"\n").starts_with("t.toml:1:"));
    const std::string hexadecimal = file_error("a = 0x1.8p1\n");
    CHECK(hexadecimal.starts_with("t.toml:1:5: not valid TOML: "));
    CHECK(hexadecimal.ends_with(R"(; write a hexadecimal float as a string: "0x1.004p+12")"));
    CHECK(file_error("a = \"\xff\"\n").starts_with("t.toml:1:"));
}

TEST_CASE("a byte order mark does not shift positions in messages") {
    CHECK(file_error("\xEF\xBB\xBF"
                     "a = 1\nb = = 2\n")
              .starts_with("t.toml:2:5: "));
    CHECK(Text("\xEF\xBB\xBF"
               "a = 0.1\n")
              .reader()
              .number("a") == real("0.1"));
}

TEST_CASE("the schema is checked before anything else") {
    CHECK(schema_error("schema = \"lostbits-scene/1\"") == "no error");
    CHECK(schema_error("\na = 1") ==
          "t.toml:1:1: schema is missing, so the meaning of the keys is unknown; write schema = \"lostbits-scene/1\" "
          "first");
    CHECK(schema_error("# c\nschema = \"lostbits-scene/2\"") ==
          "t.toml:2:10: schema is \"lostbits-scene/2\", newer than this program reads; use a newer lostbits, or write "
          "schema = \"lostbits-scene/1\"");
    CHECK(has(schema_error("schema = \"lostbits-scene/99999999999\""), "newer than this program"));
    CHECK(schema_error("schema = \"lostbits-sweep/1\"") ==
          "t.toml:1:10: schema is \"lostbits-sweep/1\", which is another kind of file than \"lostbits-scene/1\", "
          "expected here; name a file of that kind");
    CHECK(has(schema_error("schema = \"\""), "another kind of file"));
    CHECK(schema_error("schema = 1") == "t.toml:1:10: schema is the integer 1, but a string is expected here");
}

TEST_CASE("a float is read from its digits at every place of the file") {
    const Text text("\"\xc3\xa9\xc3\xa9\" = [\"\xc3\xa9\", 0.1, 1_000.000_1, +3.5e-1] # \xc3\xa9\na = { b = 0.1 }\n");
    const Node& items = text.root.entries[0].value;
    CHECK(items.items[1].text == "0.1");
    CHECK(items.items[1].where.column == 14);
    CHECK(items.items[2].text == "1000.0001");
    CHECK(items.items[3].text == "+3.5e-1");
    CHECK(text.reader().table("a").number("b") == real("0.1"));
    CHECK(text.reader().table("a").number("b") != Real(0.1));
    CHECK(Text("a = -9007199254740993").reader().number("a") == -(Real(9007199254740992) + 1));
}

TEST_CASE("a value of the wrong type says what was found and what is expected") {
    const Text text(
        "a = 1\nb = \"x\"\nc = true\n  d = [1, \"x\", 3]\ne = 1979-05-27\nf = [1, 2]\ng = []\nh = inf\ni = \"nan\"\nj "
        "= \"1e400\"\nk = 2.5\nm = -nan\nn = [1, [2], 3]\n[t]\n");
    const auto number = [&](const char* key) { return text.error([&](TableReader& t) { t.number(key); }); };
    const auto vec3 = [&](const char* key) { return text.error([&](TableReader& t) { t.vec3(key); }); };
    const auto integer = [&](const char* key) { return text.error([&](TableReader& t) { t.integer(key, 0, 5); }); };
    const std::string a_number = R"(, but a number (4100, 1e-3, "0x1.004p+12") is expected here)";
    CHECK(number("c") == "t.toml:3:5: c is the boolean true" + a_number);
    CHECK(number("e") == "t.toml:5:5: e is a date or time" + a_number);
    CHECK(number("t") == "t.toml:14:1: t is a table" + a_number);
    const std::string advice =
        R"(; write a decimal such as 4100 or "1e-3", or a hexadecimal float such as "0x1.004p+12")";
    CHECK(number("b") == "t.toml:2:5: b = \"x\" is not a number" + advice);
    CHECK(number("h") == "t.toml:8:5: h = inf is not finite" + advice);
    CHECK(number("i") == "t.toml:9:5: i = \"nan\" is not finite" + advice);
    CHECK(number("j") ==
          "t.toml:10:5: j = \"1e400\" is larger than the largest binary64, about 1.8e308; write a smaller number");
    CHECK(vec3("d") == "t.toml:4:11: d[1] = \"x\" is not a number" + advice);
    CHECK(vec3("n") == "t.toml:13:9: n[1] is an array of 1" + a_number);
    CHECK(vec3("f") == "t.toml:6:5: f is an array of 2, but an array of 3 numbers is expected here");
    CHECK(text.error([](TableReader& t) { t.numbers("g"); }) ==
          "t.toml:7:5: g is an array of 0, but an array of numbers is expected here");
    CHECK(integer("k") == "t.toml:11:5: k is the number 2.5, but a whole number from 0 to 5 is expected here");
    CHECK(text.error([](TableReader& t) { t.integer("a", 2, 5); }) ==
          "t.toml:1:5: a is the integer 1, but a whole number from 2 to 5 is expected here");
    CHECK(text.error([](TableReader& t) { t.strings("d"); }) ==
          "t.toml:4:8: d[0] is the integer 1, but a string is expected here");
    CHECK(text.error([](TableReader& t) { t.tables("t"); }) ==
          "t.toml:14:1: t is a table, but an array of tables, [[t]], is expected here");
    CHECK(text.error([](TableReader& t) { t.tables("f"); }) ==
          "t.toml:6:6: f[0] is the integer 1, but a table is expected here");
}

TEST_CASE("a missing key is reported at its table, or at its misspelling") {
    const Text text("a = 1\n[camera]\neye = 1\nlok_at = 2\n");
    CHECK(text.error([](TableReader& t) { t.number("radius"); }) ==
          R"(t.toml:1:1: radius is missing; give it a number (4100, 1e-3, "0x1.004p+12"))");
    CHECK(text.error([](TableReader& t) { t.table("camera").string("kind"); }) ==
          "t.toml:2:1: camera.kind is missing; add kind = \"...\"");
    CHECK(text.error([](TableReader& t) { t.table("camera").vec3("look_at"); }) ==
          "t.toml:4:1: camera.look_at is missing, but there is camera.lok_at; did you mean \"look_at\"?");
}

TEST_CASE("an unknown key is an error with a suggestion") {
    const Text text("radius = 1\n  raduis = 2\n");
    const auto read = [](TableReader& t) {
        t.number("radius");
        t.optional_string("title");
        t.require_known_keys();
    };
    CHECK(text.error(read) == "t.toml:2:3: unknown key raduis; did you mean \"radius\"?");
    CHECK(Text("radius = 1\nzzz = 2\n").error(read) ==
          "t.toml:2:1: unknown key zzz; known here: \"radius\", \"title\"");
    CHECK(text.error([](TableReader& t) { t.reject("raduis", "has no meaning here"); }) ==
          "t.toml:2:3: raduis has no meaning here");
}

TEST_CASE("an unknown choice is an error with a suggestion") {
    CHECK(Text("f = \"peer\"").error([](TableReader& t) { t.one_of<Fruit>("f", fruit); }) ==
          "t.toml:1:5: f is \"peer\", which is not known; did you mean \"pear\"?");
    CHECK(Text("f = \"fig\"").error([](TableReader& t) { t.optional_one_of<Fruit>("f", fruit); }) ==
          "t.toml:1:5: f is \"fig\", which is not known; known here: \"apple\", \"pear\"");
}

}  // namespace test_toml_reader
