// Rendered pictures of transformed spheres, compared with spheres that have the moved numbers, and with the map.
#include "intersect/methods.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/render/rendered.hpp"
#include "number/real.hpp"
#include "shapes/lift.hpp"

namespace test_transformed_render {

using namespace lostbits;
using namespace lostbits::measure::render;
using namespace lostbits::test;

TEST_CASE("transformed spheres are rendered like spheres with the moved numbers, mirrored or not") {
    const scene::file::Scene bare = load("raycast-course.pixels", 48, 48);
    const Collected plain({.scene = bare, .stages = all_stages, .tested_forms = rows_of({"f64"}, "sphere.unified")});
    const auto& form = *rows_of({"f64"}, "sphere.unified").front().form;
    for (const int mirror : {1, -1}) {
        scene::file::Scene transformed = bare;
        for (auto& primitive : transformed.listed) {
            const Sphere<Real> s = primitive.sphere();
            const Real r = rounded(s.radius), zero(0);
            const Vec<Real> c = rounded(s.centre);
            primitive = Primitive<Real>(Sphere<Real>{{zero, zero, zero}, Real(1)});
            primitive.transform = {
                {Real(mirror * r), zero, zero, c.x, zero, r, zero, c.y, zero, zero, r, c.z}, false, mirror};
        }
        for (const char* space : {"plain", "relative", "adjugate"}) {
            CAPTURE(mirror, space);
            const auto& row = intersect::transform::transformed_form(test::transform_method_named(space), form);
            const Collected found({.scene = transformed,
                                   .stages = all_stages,
                                   .tested_forms = {{.form = &row, .format = *find_format("f64")}}});
            std::size_t normals = 0;
            for (std::size_t i = 0; i < found.truth.size(); ++i) {
                REQUIRE(found.truth[i].has_normal == plain.truth[i].has_normal);
                REQUIRE(found.truth[i].shadow == plain.truth[i].shadow);
                for (std::size_t k = 0; k < 4; ++k) {
                    REQUIRE(found.truth[i].colours[k].is_certain);
                    REQUIRE(found.truth[i].colours[k].byte == plain.truth[i].colours[k].byte);
                }
                for (std::size_t k = 0; found.truth[i].has_normal && k < 3; ++k)
                    REQUIRE(std::fabs(found.truth[i].normal[k].hi - plain.truth[i].normal[k].hi) < 0x1p-50);
                normals += found.truth[i].has_normal;
            }
            CHECK(normals > 100);
            for (const auto& summary : found.summaries) CHECK(summary.colour_error.quantile(0.99) < 0x1p-10);
        }
    }
}

TEST_CASE("the normal of a stretched sphere is that of its surface for every transform method") {
    // Compared with finite differences of the map: the normal is perpendicular to every direction along the surface.
    scene::file::Scene scene = load("raycast-course.pixels", 32, 32);
    auto& primitive = scene.listed.front();
    const Vec<Real> c = rounded(primitive.sphere().centre);
    const Real r = rounded(primitive.sphere().radius), zero(0), half = r / 2, twice = 2 * r;
    primitive = Primitive<Real>(Sphere<Real>{{zero, zero, zero}, Real(1)});
    primitive.transform = {{half, r / 4, zero, c.x, zero, twice, zero, c.y, r / 8, zero, r, c.z}, false, 1};
    scene.listed.resize(1);
    scene.appearance.materials.resize(1);
    const auto& form = intersect::transform::transformed_form(test::transform_method_named("relative"),
                                                              *rows_of({"f64"}, "sphere.unified").front().form);
    const Collected found(
        {.scene = scene, .stages = all_stages, .tested_forms = {{.form = &form, .format = *find_format("f64")}}});
    const auto rays = scene::rays::make_shared_rays(scene, 0, scene.height);
    std::size_t normals = 0;
    for (std::size_t i = 0; i < found.truth.size(); ++i) {
        if (!found.truth[i].has_normal) continue;
        const Ray<Real> world = lift_ray<Real>(rays[i]);
        const auto in = to_object_space(world, *primitive.transform);
        const auto t = first(in.ray.origin, in.ray.direction, {zero, zero, zero}, in.scale);
        REQUIRE(t);
        const Vec<Real> q = (1 / in.scale) * (in.ray.origin + *t * in.ray.direction);
        const auto& n = found.truth[i].normal;
        const Vec<Real> normal(Real(n[0].hi), Real(n[1].hi), Real(n[2].hi));
        for (const Vec<Real>& along :
             {cross(q, Vec<Real>(Real(1), zero, zero)), cross(q, Vec<Real>(zero, Real(1), zero))}) {
            const Vec<Real> way = primitive.transform->map().linear(along);
            CHECK(abs(dot(way, normal)) < Real(0x1p-45) * length(way));
        }
        CHECK(dot(primitive.transform->map().linear(q), normal) > 0);  // outward
        ++normals;
    }
    CHECK(normals > 50);
    for (const auto& summary : found.summaries) CHECK(summary.colour_error.quantile(0.99) < 0x1p-10);
}

}  // namespace test_transformed_render
