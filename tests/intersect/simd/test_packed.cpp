// The packed kernels of every shape compared with the native rows, and the properties of the table of kernels.
#include "intersect/simd/packed_scene.hpp"
#include "number/error.hpp"

namespace lostbits::test {

using intersect::simd::Isa;

namespace {

/// Each form of the shape at every width against its scalar row.
template <class S>
void compare_forms(Shape shape) {
    const std::vector<Scene<S>> all = draw_scenes<S>(shape, share(shape, 100));
    const auto native = intersect::simd::all_packed_kernels(Isa::scalar);
    for (std::size_t form = 0; form < native.size(); ++form) {
        if (intersect::table::intersectors()[form].shape != shape || !kernel_of<S>(native[form])) continue;
        Tally tally;
        std::vector<std::size_t> wrong(intersect::simd::isa_names.size());
        for (const Scene<S>& scene : all) {
            const Answers<S> want = run(native[form], scene);
            tally.note(want);
            for (const Isa isa : intersect::simd::available_isas())
                wrong[static_cast<std::size_t>(isa)] +=
                    count_differences(run(intersect::simd::all_packed_kernels(isa)[form], scene), want);
        }
        INFO(native[form].info->name << ": finite hits " << tally.finite_hits << ", misses " << tally.misses << ", NaN "
                                     << tally.not_a_number << " of " << tally.rays);
        CHECK(wrong == std::vector<std::size_t>(intersect::simd::isa_names.size(), 0));
        tally.check(shape);
    }
}

/// Every size from nothing to the whole scene, each column ending where a page ends.
template <class S>
void compare_sizes(Shape shape, const Scene<S>& scene) {
    const auto native = intersect::simd::all_packed_kernels(Isa::scalar);
    for (std::size_t n = 0; n <= scene.size(); ++n) {
        const auto first = [&](const std::vector<S>& all) {
            return CornerRays<S>(std::span(all).first(std::min(n, all.size())));
        };
        const auto& c = scene.column;
        const CornerRays<S> ox = first(c[0]), oy = first(c[1]), oz = first(c[2]), dx = first(c[3]), dy = first(c[4]),
                            dz = first(c[5]);
        const CornerRays<S> tmax = first(scene.tmax);
        const intersect::table::RayBatch<S> rays{ox.span(), oy.span(), oz.span(),  dx.span(),
                                                 dy.span(), dz.span(), tmax.span()};
        for (const Isa isa : intersect::simd::available_isas())
            for (std::size_t form = 0; form < native.size(); ++form) {
                if (intersect::table::intersectors()[form].shape != shape || !kernel_of<S>(native[form])) continue;
                const Answers<S> got = run(intersect::simd::all_packed_kernels(isa)[form], scene.primitive, rays);
                INFO(native[form].info->name << " in " << name_of(isa) << ", " << n << " rays");
                CHECK(count_differences(got, run(native[form], scene.primitive, rays)) == 0);
                CHECK(got.margin_is_untouched());
            }
    }
}

}  // namespace

TEMPLATE_TEST_CASE("packed kernels of every shape give the bits of the native rows", "[intersect][packed]", float,
                   double) {
    for (const ShapeRow& row : shape_rows) compare_forms<TestType>(row.shape);
}

TEMPLATE_TEST_CASE("packed kernels take batches of any size and write nothing outside them", "[intersect][packed]",
                   float, double) {
    Random random(3);
    for (const ShapeRow& row : shape_rows)
        compare_sizes(row.shape, draw_scene<TestType>(random, row.shape, share(row.shape, 32) + 1));
}

TEST_CASE("a packed box kernel respects the end of each ray", "[intersect][packed]") {
    // The ray enters the box at t = 1; its end is before, in and behind the box, in neighbouring lanes.
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
            const Answers<float> got = run(intersect::simd::all_packed_kernels(isa)[form], scene);
            INFO(native[form].info->name << " in " << name_of(isa));
            for (std::size_t k = 0; k < n; ++k) CHECK(got.hit[k] == (k % 3 != 0));
        }
}

TEST_CASE("the packed table has the rows of the catalogue", "[intersect][packed]") {
    const auto rows = intersect::table::intersectors();
    for (const Isa isa : intersect::simd::available_isas()) {
        const auto packed = all_packed_kernels(isa);
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

TEST_CASE("register widths have names, and the widest is the default", "[intersect][packed]") {
    const auto isas = intersect::simd::available_isas();
    REQUIRE(isas.size() >= 2);
    CHECK(isas[0] == Isa::scalar);
    CHECK(isas[1] == Isa::w128);
    CHECK(std::is_sorted(isas.begin(), isas.end()));
    CHECK(intersect::simd::best_isa() == isas.back());
    for (const Isa isa : {Isa::scalar, Isa::w128, Isa::w256, Isa::w512}) {
        CHECK(intersect::simd::find_isa(name_of(isa)) == isa);
        CHECK(all_packed_kernels(isa).empty() == (std::find(isas.begin(), isas.end(), isa) == isas.end()));
    }
    CHECK(name_of(Isa::w256) == "256");
    CHECK_FALSE(intersect::simd::find_isa("1024"));
    CHECK_FALSE(intersect::simd::find_isa(""));
}

TEST_CASE("the current register width selects the kernels of this table's rows only", "[intersect][packed]") {
    CHECK(intersect::simd::current_isa() == intersect::simd::best_isa());
    const intersect::table::Intersector& form = intersect::table::intersectors().front();
    intersect::table::Intersector stranger = form;
    stranger.native32 = intersect::table::intersectors()[1].native32;
    for (const Isa isa : {Isa::scalar, Isa::w128, Isa::w256, Isa::w512}) {
        INFO(name_of(isa));
        const Isa before = intersect::simd::current_isa();
        if (all_packed_kernels(isa).empty()) {
            CHECK_THROWS_AS(set_isa(isa), EnvironmentError);
            CHECK(intersect::simd::current_isa() == before);
            continue;
        }
        set_isa(isa);
        CHECK(intersect::simd::current_isa() == isa);
        CHECK(intersect::simd::packed_kernels(form).f32 == all_packed_kernels(isa).front().f32);
        CHECK(intersect::simd::packed_kernels(form).f64 == all_packed_kernels(isa).front().f64);
        CHECK(intersect::simd::packed_kernels(stranger).f32 == stranger.native32);
    }
    intersect::simd::set_isa(intersect::simd::best_isa());
}

}  // namespace lostbits::test
