// The packed kernels of the boxes against the native rows: rays along faces, through corners, from planes, with and
// without an end.
#include "intersect/simd/packed_boxes.hpp"
#include "intersect/simd/packed_scene.hpp"

namespace lostbits::test {
namespace {

template <class S>
Scene<S> drawn_scene(Random& random, bool ends, std::size_t n) {
    const Box<S> box = draw_box<S>(random);
    Scene<S> scene{box, {}, {}};
    for (std::size_t k = 0; k < n; ++k) {
        scene.add(draw_ray(random, box, k));
        if (ends) scene.tmax.push_back(draw_end<S>(random));
    }
    return scene;
}

/// No picture at all: any number anywhere, lo above hi too.
template <class S>
Scene<S> wild_scene(Random& random, bool ends, std::size_t n) {
    const auto any = [&] { return draw_any<S>(random); };
    Scene<S> scene{Box<S>{Vec<S>(any(), any(), any()), Vec<S>(any(), any(), any())}, {}, {}};
    for (std::size_t k = 0; k < n; ++k) {
        scene.add({any(), any(), any(), any(), any(), any()});
        if (ends) scene.tmax.push_back(any());
    }
    return scene;
}

template <class S>
std::vector<Scene<S>> scenes() {
    std::vector<Scene<S>> all;
    Random random(256);
    for (int i = 0; i < 300; ++i) all.push_back(drawn_scene<S>(random, i % 3 != 0, 192));
    for (int i = 0; i < 300; ++i) all.push_back(wild_scene<S>(random, i % 3 != 0, 48));
    return all;
}

}  // namespace

TEST_CASE("binary32: packed box kernels give the bits of the native rows", "[intersect][packed]") {
    compare_forms(Shape::box, scenes<float>());
}
TEST_CASE("binary64: packed box kernels give the bits of the native rows", "[intersect][packed]") {
    compare_forms(Shape::box, scenes<double>());
}

TEST_CASE("packed box kernels take batches of any size and touch nothing beside them", "[intersect][packed]") {
    Random random(5);
    for (const bool ends : {false, true}) {
        compare_sizes(Shape::box, drawn_scene<float>(random, ends, 2 * widest + 1));
        compare_sizes(Shape::box, drawn_scene<double>(random, ends, 2 * widest + 1));
    }
}

TEST_CASE("a packed box kernel heeds where each ray ends", "[intersect][packed]") {
    // The ray enters the box at t = 1; the end before, in and behind it, in neighbouring lanes.
    const std::size_t n = widest + 3;
    Scene<float> scene{Box<float>{{1, -1, -1}, {2, 1, 1}}, {}, {}};
    for (std::size_t k = 0; k < n; ++k) {
        scene.add({0, 0, 0, 1, 0, 0});
        scene.tmax.push_back(k % 3 == 0 ? 0.5f : k % 3 == 1 ? 1.5f : 3.0f);
    }
    const auto native = intersect::table::intersectors();
    for (const intersect::simd::Isa isa : intersect::simd::available_isas())
        for (std::size_t form = 0; form < native.size(); ++form) {
            if (native[form].shape != Shape::box) continue;
            const Answers<float> got = run(intersect::simd::packed_rows(isa)[form], scene);
            INFO(native[form].info->name << " in " << name_of(isa));
            for (std::size_t k = 0; k < n; ++k) CHECK(got.hit[k] == (k % 3 != 0));
        }
}

}  // namespace lostbits::test
