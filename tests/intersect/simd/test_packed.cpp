// The packed kernels of the spheres against the native rows, and what the table of kernels says of itself.
#include "intersect/cases.hpp"
#include "intersect/simd/packed_scene.hpp"
#include "number/error.hpp"

namespace lostbits::test {

using intersect::simd::Isa;

namespace {

/// Setups as in cases.hpp; every third ray has a special number in one of its six components.
template <class S>
Scene<S> drawn_scene(Random& random, Setup setup, std::size_t n) {
    const auto narrow = [](const Rational& q) { return static_cast<S>(as_double(q)); };
    const Case x = as_stored<S>(draw_case(random, setup),
                                random.one_in(2) ? intersect::Direction::unit : intersect::Direction::any);
    Scene<S> scene{lift_sphere<S>(x, narrow), {}, {}};
    const Ray<S> r = lift_ray<S>(x, narrow);
    for (std::size_t k = 0; k < n; ++k) {
        std::array<S, 6> ray{r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z};
        if (k % 2 == 1)
            for (S& v : ray) v = static_cast<S>(v * (1 + random.unit() / 16));
        if (k % 3 == 2) ray[k / 3 % 6] = draw_any<S>(random);
        scene.add(ray);
    }
    return scene;
}

/// No picture at all: any number anywhere.
template <class S>
Scene<S> wild_scene(Random& random, std::size_t n) {
    const Vec<S> centre(draw_any<S>(random), draw_any<S>(random), draw_any<S>(random));
    Scene<S> scene{Sphere<S>{centre, draw_any<S>(random)}, {}, {}};
    for (std::size_t k = 0; k < n; ++k) {
        std::array<S, 6> ray;
        for (S& v : ray) v = draw_any<S>(random);
        scene.add(ray);
    }
    return scene;
}

template <class S>
std::vector<Scene<S>> scenes() {
    std::vector<Scene<S>> all;
    Random random(512);
    for (const Setup setup : every_setup)
        for (int i = 0; i < 30; ++i) all.push_back(drawn_scene<S>(random, setup, 192));
    for (int i = 0; i < 300; ++i) all.push_back(wild_scene<S>(random, 48));
    return all;
}

}  // namespace

TEST_CASE("binary32: packed sphere kernels give the bits of the native rows", "[intersect][packed]") {
    compare_forms(Shape::sphere, scenes<float>());
}
TEST_CASE("binary64: packed sphere kernels give the bits of the native rows", "[intersect][packed]") {
    compare_forms(Shape::sphere, scenes<double>());
}

TEST_CASE("packed sphere kernels take batches of any size and touch nothing beside them", "[intersect][packed]") {
    Random random(3);
    compare_sizes(Shape::sphere, drawn_scene<float>(random, Setup::near, 2 * widest + 1));
    compare_sizes(Shape::sphere, drawn_scene<double>(random, Setup::near, 2 * widest + 1));
}

TEST_CASE("the packed table has the rows of the catalogue", "[intersect][packed]") {
    const auto rows = intersect::table::intersectors();
    for (const Isa isa : intersect::simd::available_isas()) {
        const auto packed = packed_rows(isa);
        INFO(name_of(isa));
        REQUIRE(packed.size() == rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) {
            CHECK(packed[i].info == rows[i].info);
            CHECK((packed[i].f32 != nullptr) == (rows[i].native32 != nullptr));
            CHECK((packed[i].f64 != nullptr) == (rows[i].native64 != nullptr));
            // The scalar rows are the table's own; a packed row is not one of them under another name.
            CHECK((packed[i].f32 == rows[i].native32) == (isa == Isa::scalar));
        }
    }
}

TEST_CASE("register widths have names, and the widest is the best", "[intersect][packed]") {
    const auto isas = intersect::simd::available_isas();
    REQUIRE(isas.size() >= 2);
    CHECK(isas[0] == Isa::scalar);
    CHECK(isas[1] == Isa::w128);
    CHECK(std::is_sorted(isas.begin(), isas.end()));
    CHECK(intersect::simd::best_isa() == isas.back());
    for (const Isa isa : {Isa::scalar, Isa::w128, Isa::w256, Isa::w512}) {
        CHECK(intersect::simd::isa_named(name_of(isa)) == isa);
        CHECK(packed_rows(isa).empty() == (std::find(isas.begin(), isas.end(), isa) == isas.end()));
    }
    CHECK(name_of(Isa::w256) == "256");
    CHECK_FALSE(intersect::simd::isa_named("1024"));
    CHECK_FALSE(intersect::simd::isa_named(""));
}

TEST_CASE("the current width chooses the kernels of the table's rows, and of no others", "[intersect][packed]") {
    CHECK(intersect::simd::current_isa() == intersect::simd::best_isa());
    const intersect::table::Intersector& form = intersect::table::intersectors().front();
    intersect::table::Intersector stranger = form;
    stranger.native32 = intersect::table::intersectors()[1].native32;
    for (const Isa isa : {Isa::scalar, Isa::w128, Isa::w256, Isa::w512}) {
        INFO(name_of(isa));
        const Isa before = intersect::simd::current_isa();
        if (packed_rows(isa).empty()) {
            CHECK_THROWS_AS(set_isa(isa), EnvironmentError);
            CHECK(intersect::simd::current_isa() == before);
            continue;
        }
        set_isa(isa);
        CHECK(intersect::simd::current_isa() == isa);
        CHECK(intersect::simd::packed_kernels(form).f32 == packed_rows(isa).front().f32);
        CHECK(intersect::simd::packed_kernels(form).f64 == packed_rows(isa).front().f64);
        CHECK(intersect::simd::packed_kernels(stranger).f32 == stranger.native32);
    }
    intersect::simd::set_isa(intersect::simd::best_isa());
}

}  // namespace lostbits::test
