// `lostbits diff` between folders of maps, and between two forms of one.
#include <algorithm>
#include <cstdlib>

#include "catch.hpp"
#include "output/image/image.hpp"
#include "pictures.hpp"
#include "program.hpp"

namespace test_diff_maps {

using namespace lostbits::test;
namespace output = lostbits::output;

TEST_CASE("diff: folders of maps show rows, outcomes and the largest changes, and rows are paired by identity") {
    const Scratch scratch;
    const std::string head = "form,format,agree_hit,false_miss,lost_bits_p99,ulp_error_max,worst_explain\n";
    for (const char* folder : {"one/map", "two/map"}) fs::create_directories(scratch.path() / folder);
    scratch.write("one/map/summary.csv", head +
                                             "sphere.press,f32,10,0,2,5,a\n"
                                             "sphere.press,f64,10,0,1,4,a\n"
                                             "sphere.half_b,f32,10,0,nan,4,a\n");
    // Another order, a row less and a row more.
    scratch.write("two/map/summary.csv", head +
                                             "sphere.half_b,f32,10,0,3,4,a\n"
                                             "sphere.press,f32,8,2,4.5,10,b\n"
                                             "sphere.unified,f32,10,0,0,0,a\n");
    write_png(scratch / "one/map/contact.png", 6);
    write_png(scratch / "two/map/contact.png", 7);
    const auto r = run("diff one two", scratch.path());
    CHECK(r.code == 1);
    CHECK(r.out ==
          "one to two: 2 rows compared, 2 differ (in 1 table)\n"
          "1 row only in one:\n"
          "  map sphere.press f64\n"
          "1 row only in two:\n"
          "  map sphere.unified f32\n"
          "outcomes differ in 1 row:\n"
          "  map sphere.press f32: agree_hit 10 to 8, false_miss 0 to 2\n"
          "largest changes, of 3 numbers that differ:\n"
          "  map sphere.half_b f32: lost_bits_p99 nan to 3\n"
          "  map sphere.press f32: lost_bits_p99 2 to 4.5\n"
          "  map sphere.press f32: ulp_error_max 5 to 10\n"
          // No verdict if only one side has a p99 and both have as many wrong decisions.
          "not comparable in 1 row: as many wrong decisions, but only one side has a lost_bits_p99\n"
          "two is better in 0 rows, worse in 1, the same in 0 (compared by wrong decisions, then by lost_bits_p99)\n");
    const auto back = run("diff two one", scratch.path()).out;
    CHECK(has(
        back,
        "\none is better in 1 row, worse in 0, the same in 0 (compared by wrong decisions, then by lost_bits_p99)\n"));
    // Two tables without a map give the same ending if nothing has to stay the same.
    CHECK(
        has(run("diff one/map/summary.csv two/map/summary.csv", scratch.path()).out,
            "two/map/summary.csv is better in 0 rows, worse in 1, the same in 0 (compared by wrong decisions, then by "
            "lost_bits_p99)\n"));
    CHECK_FALSE(has(run("diff one/map/summary.csv two/map/summary.csv --strict", scratch.path()).out, "better"));
    // Ignored columns and differences within a tolerance do not affect the verdict.
    CHECK(has(run("diff one two --ignore false_miss --allow lost_bits_p99=3", scratch.path()).out,
              "two is better in 0 rows, worse in 0, the same in 1 (compared by lost_bits_p99)\n"));
    CHECK(has(r.err, "1 picture is not compared; --compare-pictures compares it\n"));
    CHECK(has(run("diff one two --compare-pictures", scratch.path()).out,
              "one/map/contact.png: 1 difference; -v shows it\n"));
    CHECK(run("diff one two --ignore lost_eits", scratch.path()).code == 2);

    // Pictures do not count, unless they are requested.
    fs::copy_file(scratch / "one/map/summary.csv", scratch / "two/map/summary.csv",
                  fs::copy_options::overwrite_existing);
    CHECK(run("diff one two", scratch.path()).out == "same\n");
    CHECK(run("diff one two --compare-pictures", scratch.path()).code == 1);
    CHECK(run("diff one two --strict", scratch.path()).code == 1);
    for (const char* folder : {"one", "two"}) fs::remove(scratch.path() / folder / "map/summary.csv");
    const auto nothing = run("diff one two", scratch.path());
    CHECK(nothing.code == 4);
    CHECK(has(nothing.err, "nothing but pictures"));
}

TEST_CASE("diff: rows with equal numbers name the columns that differ") {
    const Scratch scratch;
    const std::string row = "form,format,agree_hit,false_miss,lost_bits_p99,worst_explain\nsphere.press,f32,10,0,2,";
    for (const char* folder : {"one/map", "two/map"}) fs::create_directories(scratch.path() / folder);
    scratch.write("one/map/summary.csv", row + "a\n");
    scratch.write("two/map/summary.csv", row + "b\n");
    CHECK(run("diff one two", scratch.path()).out ==
          "one to two: 1 row compared, 1 differs (in 1 table)\n"
          "the numbers are the same; the rows differ in columns that name a ray or a command: worst_explain\n"
          "two is better in 0 rows, worse in 0, the same in 1 (compared by wrong decisions, then by lost_bits_p99)\n");
}

TEST_CASE("diff: pictures of different sizes are compared by shares, and only for the same scene") {
    const Scratch scratch;
    const std::string head = "form,format,rays,agree_hit,agree_miss,false_hit,false_miss,lost_bits_p99\n";
    for (const char* folder : {"small/map", "large/map"}) fs::create_directories(scratch.path() / folder);
    const auto write = [&](const std::string& folder, const std::string& rows) {
        scratch.write(folder + "/map/summary.csv", head + rows);
    };
    write("small", "mylib.mine,f32,768,509,234,22,3,13\n");
    write("large", "mylib.mine,f32,3072,2019,961,91,1,13\n");  // more of them, and a smaller share
    CHECK(
        has(run("diff small large", scratch.path()).out,
            "\nlarge is better in 1 row, worse in 0, the same in 0 (compared by the share of wrong decisions, then by "
            "lost_bits_p99)\n"));
    write("large", "mylib.mine,f32,3072,2036,936,88,12,14\n");  // the same share: then the bits decide
    CHECK(has(run("diff small large", scratch.path()).out,
              "\nlarge is better in 0 rows, worse in 1, the same in 0 (compared by "));

    // From inside, one form is asked for the exit, and the other for the near root alone.
    const std::string forms = " -i a.exit -i b.near";
    write("small", "a.exit,f32,100,60,30,0,10,3\nb.near,f32,100,20,80,0,0,2\n");
    const std::string printed = run("diff small" + forms, scratch.path()).out;
    CHECK(has(printed, "not comparable in 1 row: the two forms are asked different questions"));
    CHECK_FALSE(has(printed, "better"));
    write("small", "a.exit,f32,100,60,30,0,10,3\nb.near,f32,100,70,30,0,0,2\n");
    const std::string right = run("diff small" + forms, scratch.path()).out;
    CHECK(has(right, "\nb.near is better in 1 row, "));
    CHECK_FALSE(has(right, "equally many rays wrongly"));
    // The numbers of wrong decisions are equal, which does not show that they are on the same rays.
    write("small", "a.exit,f32,100,60,30,0,10,3\nb.near,f32,100,60,30,0,10,2\n");
    const std::string as_many = run("diff small" + forms, scratch.path()).out;
    CHECK(has(as_many, "\nin 1 row both forms decide equally many rays wrongly, perhaps not the same ones: "));
    CHECK(has(as_many, "\nb.near is better in 1 row, "));
}

TEST_CASE("diff: two forms of one folder are compared, with a difference picture, from tables and from EXR alike") {
    draw_pictures();
    const Scratch scratch;
    const std::string map = "map rtg-fig-7-3-4100-oblique --size 48x36 -f f32 -i sphere.schoolbook -i sphere.unified ";
    must(map + "--pixels csv -o csv", scratch.path());
    must(map + "--exr -o exr", scratch.path());
    const std::string forms = " -i sphere.schoolbook -i sphere.unified";
    const auto r = run("diff csv" + forms + " --draw from-csv", scratch.path());
    CHECK(r.code == 1);
    CHECK(has(r.out, "sphere.schoolbook to sphere.unified: 1 row compared, 1 differs (in 1 table)\n"));
    CHECK(has(r.out, "rtg-fig-7-3-4100-oblique f32: lost_bits_"));
    const std::string picture = "/rtg-fig-7-3-4100-oblique/sphere.schoolbook.f32-to-sphere.unified.f32.png";
    CHECK(has(r.out, "from-csv" + picture + "\n"));
    REQUIRE(run("diff exr" + forms + " --draw from-exr", scratch.path()).code == 1);
    const auto one = backend().read_png((scratch / ("from-csv" + picture)).string());
    const auto two = backend().read_png((scratch / ("from-exr" + picture)).string());
    CHECK(one.pixels == two.pixels);

    // A form compared with itself has no orange and no blue pixel; decisions that changed are black.
    REQUIRE(run("diff csv exr --draw none --ignore '*'", scratch.path()).code == 1);  // files that only one has
    const auto same = backend().read_png(scratch / "none/rtg-fig-7-3-4100-oblique/sphere.unified.f32.png");
    const output::image::Rgb8 black{0, 0, 0}, blue{20, 80, 180};
    const auto count = [](const output::image::PngImage& image, output::image::Rgb8 colour) {
        return std::ranges::count(image.pixels, colour);
    };
    CHECK(count(one, blue) > count(same, blue));
    const auto back = run("diff csv -i sphere.unified -i sphere.schoolbook --draw back", scratch.path());
    const auto worse =
        backend().read_png(scratch / "back/rtg-fig-7-3-4100-oblique/sphere.unified.f32-to-sphere.schoolbook.f32.png");
    CHECK(count(worse, black) > count(one, black));  // schoolbook misses what unified hits

    must(map + "-o bare", scratch.path());
    const auto bare = run("diff bare" + forms + " --draw no", scratch.path());
    CHECK(bare.code == 2);
    CHECK(has(bare.err, "--pixels csv or --exr"));
    CHECK_FALSE(fs::exists(scratch / "no"));
}

TEST_CASE("diff: folders made with other options are reported first") {
    const Scratch scratch;
    const auto map = [&](const std::string& options) {
        must("map near-benign -i sphere.press -f f32 -q " + options, scratch.path());
    };
    map("--size 16x12 --set 'sphere[0].radius=1.5' -o one");
    map("--size 20x12 --set 'sphere[0].radius=1.5' -o two");
    map("--size 16x12 --set 'sphere[0].radius=1.5,camera.fov_deg=30' --exr -o three");
    const std::string heading = "made with other options, which may explain all differences:\n";
    CHECK(run("diff one two", scratch.path())
              .out.starts_with(heading + "  --size 16x12 in one/near-benign, 20x12 in two/near-benign\none to two: "));
    const auto other = run("diff one three", scratch.path()).out;
    CHECK(other.starts_with(heading + "  --set camera.fov_deg=30 only in three/near-benign\none to three: "));
    CHECK(run("diff one/near-benign/summary.csv two/near-benign/summary.csv", scratch.path()).out.starts_with(heading));
    // Options that only choose rows and columns change no number, and a folder without a manifest names no options: no
    // heading.
    map("--size 16x12 --set 'sphere[0].radius=1.5' --metric residual --pixels csv -o four");
    CHECK_FALSE(has(run("diff one four", scratch.path()).out, heading));
    fs::remove(scratch / "two/near-benign/manifest.json");
    CHECK_FALSE(has(run("diff one two", scratch.path()).out, heading));
    CHECK(run("diff one one", scratch.path()).out == "same\n");
}

}  // namespace test_diff_maps
