// A file of rays says the same in every container, and says where it is wrong.
#include "scene/ray_file/ray_file.hpp"

#include <cmath>

#include "catch.hpp"
#include "measure/seeded.hpp"
#include "scene/ray_file/number_parser.hpp"
#include "scene/ray_file/ray_file_writer.hpp"
#include "shapes/number_names.hpp"

namespace test_ray_file {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::ray_file;
using namespace lostbits::scene::test;

namespace {

/// Rays with a sphere each and answers, all numbers of binary32.
Columns sphere_columns(std::size_t rows) {
    lostbits::test::Seeded random(7);
    const auto any = [&] {
        return static_cast<double>(static_cast<float>(
            random.sign() * std::ldexp(1.0 + 0x1p-23 * static_cast<double>(random.bits(23)), random.index(20) - 10)));
    };
    Columns columns;
    for (const char* name : {"ox", "oy", "oz", "dx", "dy", "dz", "cx", "cy", "cz", "radius", "t"}) {
        std::vector<double> column(rows);
        for (double& x : column)
            x = std::string(name) == "radius" || std::string(name) == "t" ? std::fabs(any()) : any();
        columns.add(name, column);
    }
    std::vector<double> hit(rows);
    for (double& x : hit) x = random.coin() ? 1 : 0;
    columns.add("hit", hit);
    return columns;
}

void require_same(const std::vector<Chunk>& chunks, const Columns& c) {
    std::size_t row = 0;
    for (const Chunk& chunk : chunks) {
        REQUIRE(chunk.first == row);
        REQUIRE(chunk.rounded_count == 0);
        REQUIRE(chunk.primitives.size() == chunk.size());
        for (std::size_t i = 0; i < chunk.size(); ++i, ++row) {
            const Ray<double> ray = chunk.rays[i];
            for (int k = 0; k < 3; ++k) {
                REQUIRE(ray.origin[k] == c.numbers[k][row]);
                REQUIRE(ray.direction[k] == c.numbers[static_cast<std::size_t>(k) + 3][row]);
            }
            for (std::size_t k = 0; k < 4; ++k) REQUIRE(chunk.primitives[i].numbers[k] == c.numbers[6 + k][row]);
            REQUIRE(chunk.hit[i] == c.numbers[11][row]);
            if (chunk.hit[i] != 0) REQUIRE(chunk.t[i] == c.numbers[10][row]);
        }
    }
    REQUIRE(row == c.rows());
}

void require_reads(const std::string& name, const std::string& bytes, const ReadOptions& options,
                   const Columns& columns, const std::string& format) {
    INFO(name << " " << options.columns);
    const ScratchRayFile file(name, bytes);
    for (const std::size_t most : {1U, 7U, 64U, 1000U}) {
        const auto ray_file = open_ray_file(file.path(), options);
        CHECK(ray_file->format().name == format);
        require_same(read_all(*ray_file, most), columns);
    }
}

}  // namespace

TEST_CASE("every file format of rays gives the same rays") {
    const Columns columns = sphere_columns(257);
    const std::string names = columns.joined_names();
    const auto hex = [](double x) { return output::file::hex(x); };
    const auto shortest = [](double x) { return output::file::decimal(static_cast<float>(x)); };
    const auto nine = [](double x) {
        char text[40];
        std::snprintf(text, sizeof text, "%.9g", x);
        return std::string(text);
    };
    const auto f32 = find_format("f32");
    require_reads("a.csv", to_csv(columns, hex), {}, columns, "f64");
    require_reads("a.csv", to_csv(columns, hex), {.format = f32}, columns, "f32");
    require_reads("a.csv", to_csv(columns, shortest), {.format = f32}, columns, "f32");
    require_reads("a.csv", to_csv(columns, nine), {.format = f32}, columns, "f32");
    require_reads("a.txt", to_csv(columns, hex), {.container = Container::csv}, columns, "f64");
    std::string crlf = to_csv(columns, hex);
    for (std::size_t at = 0; (at = crlf.find('\n', at)) != std::string::npos; at += 3) crlf.replace(at, 1, "\r\n\n");
    require_reads("a.csv", "\xEF\xBB\xBF" + crlf, {}, columns, "f64");
    const std::string bare = to_csv(columns, hex).substr(names.size() + 1);
    require_reads("a.csv", bare, {.columns = names}, columns, "f64");
    for (const bool big : {false, true}) {
        const std::string be = big ? "be" : "";
        for (const ArrayOrder order : {ArrayOrder::rows, ArrayOrder::columns}) {
            require_reads("a.npy", to_npy<float>(columns, big, order), {.columns = names}, columns, "f32");
            require_reads("a.npy", to_npy<double>(columns, big, order), {.columns = names}, columns, "f64");
        }
        require_reads("a.bin", to_bytes<float>(columns, big), {.columns = columns.joined_names(":f32" + be)}, columns,
                      "f32");
        require_reads("a.bin", "head" + to_bytes<double>(columns, big),
                      {.columns = "ox:f64" + be + names.substr(2), .skip = 4}, columns, "f64");
    }
}

TEST_CASE("fields of an array keep their types, and fields of three numbers are vectors") {
    const Columns columns = sphere_columns(100);
    std::string bytes;
    for (std::size_t i = 0; i < columns.rows(); ++i) {
        const auto at = [&](std::size_t c) { return columns.numbers[c][i]; };
        for (std::size_t c = 0; c < 3; ++c) append<double>(bytes, at(c), true);
        for (std::size_t c = 3; c < 6; ++c) append<float>(bytes, at(c), false);
        append<std::int32_t>(bytes, static_cast<double>(i) - 50, false);
        for (std::size_t c = 6; c < 10; ++c) append<float>(bytes, at(c), false);
        append<bool>(bytes, at(11), false);
        append<float>(bytes, at(10), false);
    }
    const std::string fields =
        "[('o', '>f8', (3,)), ('direction', '<f4', 3), ('id', '<i4'), ('sphere', '<f4', (4,)), ('hit', '|b1'), ('t', "
        "'<f4')]";
    const std::string npy = to_npy("{'descr': " + fields + ", 'fortran_order': False, 'shape': (10, 10), }", bytes);
    require_reads("a.npy", npy, {}, columns, "f32");
    const ScratchRayFile file("a.npy", npy);
    const auto ray_file = open_ray_file(file.path(), {.keeps_own_columns = true});
    CHECK(ray_file->picture() == std::pair{10, 10});
    CHECK(ray_file->layout().kept_columns() == std::vector<std::string>{"id"});
    CHECK(read_all(*ray_file, 10)[1].kept[3] == "-37");
}

TEST_CASE("decimals are rounded once to the format, and values that it cannot hold are counted") {
    const NumberParser f32(*find_format("f32")), f64(*find_format("f64")), p5(*find_format("p5"));
    // Between two floats, a bit above the middle: rounded to double first it is the middle, and goes to even.
    const std::string above = "1.00000005960464477539062500000000001";
    CHECK(f32.read(above).value == 0x1.000002p0);
    CHECK_FALSE(f32.read(above).is_representable);
    CHECK(f64.read(above).value == 0x1.000001p0);
    CHECK(p5.read("1.03125000000000000000000000000000000001").value == 0x1.1p0);
    CHECK(f32.read("0.1").value == static_cast<double>(0.1F));
    CHECK(f32.read("0.1").is_representable);
    CHECK(f32.read("0.10000000149011612").is_representable);  // the same float as double and printf write it
    CHECK(f32.read("0.100000001490116119384765625").is_representable);
    CHECK_FALSE(f32.read("0.1000000123").is_representable);
    CHECK(f64.read("0.1").is_representable);
    CHECK_FALSE(f64.read("0.10000000000000000009").is_representable);
    CHECK_FALSE(f32.read("0x1.0000001p0").is_representable);
    CHECK(f32.read("0x1.0000011p0").value == 0x1.000002p0);
    CHECK(f64.read("-0x1.00000000000008000000001p0").value == -0x1.0000000000001p0);
    CHECK(std::signbit(f64.read("-0").value));
    CHECK(f64.read("+1e-400").value == 0);
    CHECK_FALSE(f64.read("+1e-400").value != 0);
    CHECK(f32.read("1e-45").value == 0x1p-149);
    CHECK(f32.read("1e39").kind == NumberParser::Kind::too_large);
    CHECK(f64.read("-INF").value == -HUGE_VAL);
    CHECK(std::isnan(f64.read("NaN").value));
    for (const char* word : {"", "-", "1e", "0x", "0x1p", "1.2.3", "1,5", "nano", "infinit", "1f", "--1", "1 2"})
        CHECK(f64.read(word).kind == NumberParser::Kind::not_numeric);
}

namespace {

const std::string head = "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius,hit,t\n";

}  // namespace

TEST_CASE("a t means a hit or a miss as declared where no column says so") {
    const auto hits = [](const std::string& t, std::optional<MissRule> miss) {
        const ScratchRayFile file("a.csv", "ox,oy,oz,dx,dy,dz,t\n0,0,-5,0,0,1," + t + "\n");
        const auto ray_file =
            open_ray_file(file.path(), {.format = find_format("f32"), .miss = miss, .primitive = Shape::sphere});
        return read_all(*ray_file).front().hit.front() != 0;
    };
    const MissRule never{MissRule::Kind::never}, negative{MissRule::Kind::negative},
        far{MissRule::Kind::number, 3.4028235e38};
    for (const char* miss : {"", "nan", "inf", "-inf"}) CHECK_FALSE(hits(miss, {}));
    CHECK(hits("4", {}));
    CHECK(hits("-0", {}));
    CHECK(hits("-1", never));
    CHECK_FALSE(hits("-1", negative));
    CHECK(hits("0", negative));
    CHECK_FALSE(hits("3.40282347e+38", far));
    CHECK(hits("3e38", far));
    CHECK_FALSE(hits("nan", never));
}

namespace {

/// 1, 4, 9, … of the numbers of a shape in their own order, but for one that is below the one before it: every limit is
/// kept.
std::vector<int> squares_of(const ShapeRow& row) {
    std::vector<int> all(row.number_count);
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<int>((k + 1) * (k + 1));
    for_each_key(row.shape, [&](const Key& key, std::size_t k) {
        if (key.limit == Key::Limit::non_negative_below_previous || key.limit == Key::Limit::positive_below_previous)
            all[k] = all[k - 1] - 1;
    });
    return all;
}

}  // namespace

TEST_CASE("the columns of each shape give its numbers in either order") {
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        const std::vector<int> numbers = squares_of(row);
        std::vector<std::string> names(column_names(row.shape).begin(), column_names(row.shape).end());
        for (const bool reversed : {false, true}) {
            if (reversed) std::ranges::reverse(names);
            std::string text = "ox,oy,oz,dx,dy,dz", line = "\n0,0,-5,0,0,1";
            for (std::size_t k = 0; k < row.number_count; ++k) {
                const int x = numbers[reversed ? row.number_count - 1 - k : k];
                text += "," + names[k], line += "," + std::to_string(x);
            }
            const ScratchRayFile file("a.csv", text + ",t" + line + ",1\n");
            const Chunk chunk = read_all(*open_ray_file(file.path(), {})).front();
            REQUIRE(chunk.primitives.front().shape == row.shape);
            for (std::size_t k = 0; k < row.number_count; ++k) CHECK(chunk.primitives.front().numbers[k] == numbers[k]);
        }
    }
}

TEST_CASE("numbers of a shape with missing columns are the user's own columns") {
    const std::string first = "ox,oy,oz,dx,dy,dz,cx,cy,cz,nx,ny,nz,";
    const ScratchRayFile spheres("a.csv", first + "radius,t\n0,0,-5,0,0,1,1,2,3,0,0,1,2,4\n");
    const auto ray_file = open_ray_file(spheres.path(), {.keeps_own_columns = true});
    CHECK(ray_file->layout().kept_columns() == std::vector<std::string>{"nx", "ny", "nz"});
    CHECK(read_all(*ray_file).front().primitives.front().numbers ==
          Primitive<double>(Sphere<double>{{1, 2, 3}, 2}).numbers);
    const ScratchRayFile discs("a.csv", first + "outer_radius,t\n0,0,-5,0,0,1,1,2,3,0,0,1,2,4\n");
    CHECK(read_all(*open_ray_file(discs.path(), {})).front().primitives.front().numbers ==
          Primitive<double>(Disc<double>{{1, 2, 3}, {0, 0, 1}, 2, 0}).numbers);
}

TEST_CASE("a hit at NaN is an answer, and the t of a miss is ignored") {
    const ScratchRayFile file(
        "a.csv", head + "0,0,-5,0,0,1,0,0,0,1,1,nan\n0,0,-5,0,0,1,0,0,0,1,0,\n0,0,-5,0,0,1,0,0,0,1,false,nan\n");
    const Chunk chunk = read_all(*open_ray_file(file.path(), {})).front();
    CHECK(chunk.hit == std::vector<std::uint8_t>{1, 0, 0});
    CHECK(std::isnan(chunk.t[0]));
    CHECK(chunk.t[1] == 0);
    CHECK(chunk.t[2] == 0);
}

TEST_CASE("quoted cells may hold commas and newlines, and line numbers count them") {
    const std::string text = "note,\"ox\",oy,oz,dx,dy,dz\n\"a, \"\"b\"\"\nc\",\"1\", 2 ,3,4,5,6\n\nx,1,2,3,4,5,six\n";
    CHECK(fault_of("a.csv", text, {.primitive = Shape::sphere}).starts_with("a.csv:5:13: dz \"six\" is not a number"));
    const ScratchRayFile file("a.csv", text.substr(0, text.find("x,1,2")));
    const Chunk chunk =
        read_all(*open_ray_file(file.path(), {.primitive = Shape::sphere, .keeps_own_columns = true})).front();
    CHECK(chunk.kept == std::vector<std::string>{"a, \"b\"\nc"});
    CHECK(chunk.rays.dz == std::vector<double>{6});
}

TEST_CASE("columns named as in the project's tables are recognised, and hexadecimal ones are preferred") {
    const std::string text =
        "t,t_hex,origin_x_hex,ORIGIN_Y,origin_z,direction_x,direction_y,direction_z,centre_x,centre_y,centre_z,radius\n"
        "9,0x1p2,0x1p1,0,0,1,0,0,0,0,0,1\n";
    const ScratchRayFile file("a.csv", text);
    const auto ray_file = open_ray_file(file.path(), {});
    CHECK(ray_file->layout().kept_columns() == std::vector<std::string>{"t"});
    const Chunk chunk = read_all(*ray_file).front();
    CHECK(chunk.t.front() == 4);
    CHECK(chunk.rays.ox.front() == 2);
}

}  // namespace test_ray_file
