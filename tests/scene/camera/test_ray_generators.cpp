// Ways to make rays, against fractions: a camera whose axes are (2, 3, 6)/7 and so on, and whose tangent is 1.
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>

#include "catch.hpp"
#include "number/real.hpp"
#include "scene/camera/ray_generators.hpp"
#include "scene/rays/generated_rays.hpp"
#include "scene/scene_text.hpp"

namespace test_ray_generators {

using namespace lostbits;
using namespace lostbits::scene;
using scene::camera::ray_generators;
using scene::camera::RayGenerator;
using scene::test::load_text;
using Fraction = boost::multiprecision::cpp_rational;
using Fractions = std::array<Fraction, 3>;

namespace {

constexpr int width = 6, height = 4;

std::string scene_of(const std::string& eye, const std::string& look_at, const std::string& projection) {
    return "schema = \"lostbits-scene/1\"\ntitle = \"A test\"\nsize = [6, 4]\n[camera]\nkind = \"pinhole\"\neye = [" +
           eye + "]\nlook_at = [" + look_at + "]\nup = [3, -6, 2]\nfov_deg = 90\n[camera.projection]\n" + projection +
           "\n[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\n";
}

/// forward (2, 3, 6)/7, up (3, -6, 2)/7, right forward x up = (6, 2, -3)/7.
Fractions direction_of(int x, int y) {
    const Fraction a = (Fraction(2 * x + 1, width) - 1) * Fraction(width, height), b = 1 - Fraction(2 * y + 1, height);
    Fractions d;
    const int forward[] = {2, 3, 6}, up[] = {3, -6, 2}, right[] = {6, 2, -3};
    for (std::size_t k = 0; k < 3; ++k) d[k] = (forward[k] + a * right[k] + b * up[k]) / 7;
    return d;
}

/// Every binary number is a fraction.
Fraction exactly(const Real& x) {
    if (x == 0) return 0;
    int exponent = 0;
    const Real scaled = ldexp(frexp(x, &exponent), 512);
    const Fraction digits(scaled.convert_to<boost::multiprecision::cpp_int>());
    const int shift = exponent - 512;
    const Fraction power(boost::multiprecision::cpp_int(1) << std::abs(shift));
    return shift < 0 ? Fraction(digits / power) : Fraction(digits * power);
}
Fractions exactly(const Vec<Real>& v) { return {exactly(v.x), exactly(v.y), exactly(v.z)}; }

Fraction dot(const Fractions& a, const Fractions& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
/// |a x b|^2
Fraction cross2(const Fractions& a, const Fractions& b) {
    const Fraction ab = dot(a, b);
    return dot(a, a) * dot(b, b) - ab * ab;
}

const Fraction tiny = Fraction(1) / (boost::multiprecision::cpp_int(1) << 400);  // of a square: 2^-200

/// True if a ray goes through its pixel, to 2^-200 of its direction, and begins so far off from where it should.
void check_ray(const Ray<Real>& ray, int pixel, const Fraction& near, const Fraction& off_at_most) {
    const Fractions d = direction_of(pixel % width, pixel / width), made = exactly(ray.direction);
    CHECK(cross2(made, d) < tiny * dot(d, d));
    CHECK(dot(made, d) > 0);
    const int eye[] = {100, -20, 7};
    Fractions off = exactly(ray.origin);
    for (std::size_t k = 0; k < 3; ++k) off[k] -= eye[k] + near * d[k];
    CHECK(dot(off, off) < off_at_most);
}

struct Planes {
    std::string text;
    Fraction near;
    std::set<std::string> without = {};  ///< ways whose literal depths mean nothing there
};

const Planes planes[] = {
    {"near = 0.25\nfar = 64\ndepth = \"gl\"", Fraction(1, 4)},
    {"near = 0.25\nfar = 64\ndepth = \"zero_to_one\"", Fraction(1, 4)},
    {"near = 2\nfar = 1024\ndepth = \"reversed\"", Fraction(2)},
    {"near = 2", Fraction(2), {"glm"}},
    {"near = 2\ndepth = \"reversed\"", Fraction(2), {"glm", "dxr"}},
};

}  // namespace

TEST_CASE("every ray generator gives the exact ray of the pixel when nothing is rounded") {
    for (const Planes& p : planes) {
        const file::Scene plain = load_text(scene_of("100, -20, 7", "102, -17, 13", p.text));
        const auto numbers = rays::compute_camera_numbers(plain);
        for (const RayGenerator& generator : ray_generators()) {
            if (p.without.contains(std::string(generator.info->name))) continue;
            CAPTURE(p.text, generator.info->name);
            int pixel = 0;
            generator.real(numbers, {0, height}, [&](const Ray<Real>& ray) {
                const Fractions made = exactly(ray.direction);
                CHECK(abs(dot(made, made) - 1) < Fraction(1) / (boost::multiprecision::cpp_int(1) << 200));
                check_ray(ray, pixel++, generator.info->starts_on_near_plane ? p.near : Fraction(0), tiny * 1000000);
            });
            CHECK(pixel == width * height);
        }
    }
}

TEST_CASE("ideal rays agree with fractions, from the eye or from the near plane") {
    for (const RayGenerator& generator : ray_generators()) {
        const file::Scene scene =
            with_ray_generator(load_text(scene_of("100, -20, 7", "102, -17, 13", "near = 0.25\nfar = 64")), generator);
        const auto ideal = rays::make_own_rays(scene, 1, 3);
        REQUIRE(ideal.generated_rays);
        REQUIRE(ideal.size() == 2 * width);
        for (std::size_t i = 0; i < ideal.size(); ++i)
            check_ray(ideal[i], width + static_cast<int>(i), Fraction(generator.info->starts_on_near_plane ? 1 : 0, 4),
                      tiny);
    }
}

TEST_CASE("ray generators give the same rays in machine floats and in emulated formats") {
    const file::Scene plain =
        load_text(scene_of("7401.3, 5921.1, 7896.7", "7399, 5930, 7890", "near = 0.1\nfar = 1000"));
    const auto numbers = rays::compute_camera_numbers(plain);
    for (const RayGenerator& generator : ray_generators()) {
        CAPTURE(generator.info->name);
        const file::Scene scene = with_ray_generator(plain, generator);
        const rays::GeneratedRays made(scene);
        for (const FloatFormat& format : {binary32, binary64}) {
            const rays::RayBlock native = made.make_rounded_rays(format, 0, height);
            const CurrentFormat::Scope scope(format);
            const auto stored = rays::compute_camera_numbers(scene).each(
                [&](const Real& x) { return RoundedAny(toml::round_to_format(x, format)); });
            std::size_t i = 0;
            generator.rounded(stored, {0, height}, [&](const Ray<RoundedAny>& ray) {
                const Ray<double> one = native[i++];
                for (int k = 0; k < 3; ++k) {
                    CHECK(one.origin[k] == ray.origin[k].value());
                    CHECK(one.direction[k] == ray.direction[k].value());
                }
            });
            CHECK(i == native.size());
        }
    }
}

TEST_CASE("the tape of a ray generator gives its rays from the camera's numbers") {
    const file::Scene plain =
        load_text(scene_of("7401.3, 5921.1, 7896.7", "7399, 5930, 7890", "near = 0.1\nfar = 1000"));
    for (const RayGenerator& generator : ray_generators()) {
        const file::Scene scene = with_ray_generator(plain, generator);
        const rays::GeneratedRays made(scene);
        for (const char* name : {"f32", "f64", "fp16"}) {
            CAPTURE(generator.info->name, name);
            const Format format = *find_format(name);
            const rays::RayBlock native = made.make_rounded_rays(format.parameters, 0, height);
            for (const auto& [x, y] : {std::pair(0, 0), std::pair(width - 1, 2)}) {
                const rays::RecordedRay recorded = made.record_ray(format, {x, y});
                const Ray<double> one = native[y * width + x];
                for (std::size_t k = 0; k < 6; ++k) {
                    const double value = recorded.tape[recorded.ray[k]].value;
                    const double there = (k < 3 ? one.origin : one.direction)[static_cast<int>(k % 3)];
                    CHECK((value == there || (std::isnan(value) && std::isnan(there))));
                }
                std::size_t inputs = 0;
                for (const TapeNode& node : recorded.tape.nodes) inputs += node.op == TapeOp::input ? 1 : 0;
                CHECK(inputs == recorded.names.size());
                const std::set<std::string> names(recorded.names.begin(), recorded.names.end());
                CHECK(names.size() == inputs);
                CHECK((names.contains("pixel.x") || names.contains("pixel.left")));
                CHECK(names.size() < camera::camera_number_names().size() / 2);
            }
        }
    }
}

TEST_CASE("generators that rotate a direction in camera space give the same rays for every camera position") {
    const auto directions = [](const RayGenerator& generator, const std::string& eye, const std::string& look_at) {
        const file::Scene scene =
            with_ray_generator(load_text(scene_of(eye, look_at, "near = 0.125\nfar = 1024")), generator);
        const rays::RayBlock block = rays::GeneratedRays(scene).make_rounded_rays(binary32, 0, height);
        return std::vector<std::vector<double>>{block.dx, block.dy, block.dz};
    };
    const std::set<std::string_view> apart{"bevy_view", "nvpro", "godot", "optix", "pbrt", "differentials", "relative"};
    for (const RayGenerator& generator : ray_generators()) {
        CAPTURE(generator.info->name);
        const auto here = directions(generator, "0, 0, 0", "2, 3, 6");
        const auto far = directions(generator, "67108864, -33554432, 8388608", "67108880, -33554408, 8388656");
        CHECK((here == far) == apart.contains(generator.info->name));
    }
}

TEST_CASE("shared inputs round the camera itself to binary32") {
    const std::string text = scene_of("0.1, 0.2, 0.3", "0.7, 5, 9", "near = 0.1\nfar = 1000.1");
    const file::Scene scene = with_ray_generator(load_text(text), *camera::find_ray_generator("three"));
    CHECK(scene.inputs == file::InputRounding::own);
    CHECK(scene.camera.eye.x == Real(0.1F));
    CHECK(scene.camera.projection->near == Real(0.1F));
    CHECK(*scene.camera.projection->far == Real(1000.1F));
    const file::Scene own =
        with_ray_generator(load_text(scene::test::replace_text(text, "size =", "inputs = \"own\"\nsize =")),
                           *camera::find_ray_generator("three"));
    CHECK(own.camera.eye.x == scene::test::real("0.1"));
}

TEST_CASE("no ray is generated where w is 0: an infinite far plane, or z = 0 with reversed depth") {
    for (const auto& [planes_text, name] : {std::pair("near = 2\ndepth = \"reversed\"", "dxr"),
                                            {"near = 2\ndepth = \"reversed\"", "glm"},
                                            {"near = 2", "glm"}}) {
        const file::Scene scene = with_ray_generator(load_text(scene_of("0, 0, 0", "2, 3, 6", planes_text)),
                                                     *camera::find_ray_generator(name));
        const rays::RayBlock block = rays::GeneratedRays(scene).make_rounded_rays(binary32, 0, height);
        for (std::size_t i = 0; i < block.size(); ++i) CHECK_FALSE(std::isfinite(block.dx[i]));
    }
}

}  // namespace test_ray_generators
