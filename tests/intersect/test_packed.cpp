// The packed kernels against the native rows, to the bit: hit, t, near and far, also where hit is false, because the same
// operations on the same numbers leave the same numbers.
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <vector>

#include "catch.hpp"
#include "intersect/cases.hpp"
#include "intersect/packed.hpp"
#include "number/draw.hpp"

namespace lostbits::test {
namespace {

constexpr float untouched = -12345;
constexpr std::size_t widest = 16;

/// Rays against one sphere, as columns.
template <class S>
struct Scene {
    Sphere<S> sphere;
    std::vector<S> column[6];

    void add(const std::array<S, 6>& ray) {
        for (std::size_t i = 0; i < 6; ++i) column[i].push_back(ray[i]);
    }
    [[nodiscard]] std::size_t size() const { return column[0].size(); }
};

/// Numbers whose end is the end of a page that nobody may touch the neighbour of: one read too far is a fault.
template <class S>
class Cornered {
public:
    explicit Cornered(std::span<const S> x) : size_(x.size()) {
        REQUIRE(x.size_bytes() <= page);
        REQUIRE(memory_ != MAP_FAILED);
        REQUIRE(mprotect(memory_ + page, page, PROT_NONE) == 0);
        std::copy(x.begin(), x.end(), data());
    }
    Cornered(const Cornered&) = delete;
    Cornered& operator=(const Cornered&) = delete;
    ~Cornered() { munmap(memory_, 2 * page); }
    [[nodiscard]] std::span<const S> span() const { return {data(), size_}; }

private:
    [[nodiscard]] S* data() const { return reinterpret_cast<S*>(memory_ + page) - size_; }

    const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    char* memory_ = static_cast<char*>(mmap(nullptr, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    std::size_t size_;
};

/// Answers with a margin behind them that no kernel may touch.
template <class S>
struct Answers {
    std::vector<S> t, near, far;
    std::vector<std::uint8_t> hit;
    std::size_t size;

    explicit Answers(std::size_t n) : t(n + widest, untouched), near(t), far(t), hit(n + widest, 77), size(n) {}
    HitBatch<S> batch() { return {std::span(t).first(size), std::span(near).first(size), std::span(far).first(size), std::span(hit).first(size)}; }
    [[nodiscard]] bool margin_is_untouched() const {
        for (std::size_t i = size; i < t.size(); ++i)
            if (t[i] != untouched || near[i] != untouched || far[i] != untouched || hit[i] != 77) return false;
        return true;
    }
};

template <class S>
auto kernel_of(const PackedRow& row) {
    if constexpr (std::same_as<S, float>) return row.f32;
    else return row.f64;
}

template <class S>
Answers<S> run(const PackedRow& row, const Sphere<S>& sphere, const RayBatch<S>& rays) {
    Answers<S> answers(rays.size());
    kernel_of<S>(row)(rays, sphere, answers.batch());
    return answers;
}

template <class S>
Answers<S> run(const PackedRow& row, const Scene<S>& scene) {
    const auto& c = scene.column;
    return run(row, scene.sphere, RayBatch<S>{c[0], c[1], c[2], c[3], c[4], c[5]});
}

template <class S>
bool same(S a, S b) {
    return std::isnan(a) ? std::isnan(b) : std::memcmp(&a, &b, sizeof a) == 0;
}

template <class S>
std::size_t differences(const Answers<S>& a, const Answers<S>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size; ++i)
        count += a.hit[i] != b.hit[i] || !same(a.t[i], b.t[i]) || !same(a.near[i], b.near[i]) || !same(a.far[i], b.far[i]);
    return count;
}

template <class S>
constexpr FloatFormat format_of = std::same_as<S, float> ? binary32 : binary64;

/// ±0, ±∞, NaN, the least and the greatest subnormal and normal numbers, or any finite number.
template <class S>
S draw_any(Random& random) {
    const FloatFormat f = format_of<S>;
    return static_cast<S>(random.one_in(3) ? draw_special(random, f) : draw_finite(random, f));
}

/// Setups as in cases.hpp; every third ray has a special number in one of its six components.
template <class S>
Scene<S> drawn_scene(Random& random, Setup setup, std::size_t n) {
    const auto narrow = [](const Rational& q) { return static_cast<S>(as_double(q)); };
    const Case x = as_stored<S>(draw_case(random, setup), random.one_in(2) ? Direction::unit : Direction::any);
    Scene<S> scene{lift_sphere<S>(x, narrow), {}};
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
    Scene<S> scene{{Vec<S>(draw_any<S>(random), draw_any<S>(random), draw_any<S>(random)), draw_any<S>(random)}, {}};
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

struct Tally {
    std::size_t rays = 0, finite_hits = 0, misses = 0, not_a_number = 0;

    template <class S>
    void note(const Answers<S>& a) {
        for (std::size_t i = 0; i < a.size; ++i) {
            ++rays;
            finite_hits += a.hit[i] == 1 && std::isfinite(a.t[i]);
            misses += a.hit[i] == 0;
            not_a_number += std::isnan(a.t[i]);
        }
    }
};

template <class S>
void compare_forms() {
    const auto all = scenes<S>();
    const auto native = packed_sphere_rows(Isa::scalar);
    for (std::size_t form = 0; form < native.size(); ++form) {
        if (!kernel_of<S>(native[form])) continue;
        Tally tally;
        std::vector<std::size_t> wrong(isa_names.size());
        for (const Scene<S>& scene : all) {
            const Answers<S> want = run(native[form], scene);
            tally.note(want);
            for (const Isa isa : available_isas())
                wrong[static_cast<std::size_t>(isa)] += differences(run(packed_sphere_rows(isa)[form], scene), want);
        }
        INFO(native[form].info->name << ": finite hits " << tally.finite_hits << ", misses " << tally.misses << ", NaN " << tally.not_a_number << " of "
                                     << tally.rays);
        CHECK(wrong == std::vector<std::size_t>(isa_names.size(), 0));
        CHECK(tally.finite_hits > tally.rays / 10);
        CHECK(tally.misses > tally.rays / 20);
        CHECK(tally.not_a_number > tally.rays / 100);
    }
}

/// Every size from nothing to two packs and one, from every alignment that the end of a page leaves.
template <class S>
void compare_sizes() {
    Random random(3);
    const Scene<S> scene = drawn_scene<S>(random, Setup::near, 2 * widest + 1);
    const auto native = packed_sphere_rows(Isa::scalar);
    for (std::size_t n = 0; n <= scene.size(); ++n) {
        const auto first = [&](std::size_t c) { return Cornered<S>(std::span(scene.column[c]).first(n)); };
        const Cornered<S> ox = first(0), oy = first(1), oz = first(2), dx = first(3), dy = first(4), dz = first(5);
        const RayBatch<S> rays{ox.span(), oy.span(), oz.span(), dx.span(), dy.span(), dz.span()};
        for (const Isa isa : available_isas())
            for (std::size_t form = 0; form < native.size(); ++form) {
                if (!kernel_of<S>(native[form])) continue;
                const Answers<S> got = run(packed_sphere_rows(isa)[form], scene.sphere, rays);
                INFO(native[form].info->name << " in " << name_of(isa) << ", " << n << " rays");
                CHECK(differences(got, run(native[form], scene.sphere, rays)) == 0);
                CHECK(got.margin_is_untouched());
            }
    }
}

}  // namespace

TEST_CASE("binary32: packed kernels give the bits of the native rows", "[intersect][packed]") { compare_forms<float>(); }
TEST_CASE("binary64: packed kernels give the bits of the native rows", "[intersect][packed]") { compare_forms<double>(); }

TEST_CASE("packed kernels take batches of any size and touch nothing beside them", "[intersect][packed]") {
    compare_sizes<float>();
    compare_sizes<double>();
}

TEST_CASE("the packed table has the rows of the catalogue", "[intersect][packed]") {
    const auto rows = sphere_intersectors();
    for (const Isa isa : available_isas()) {
        const auto packed = packed_sphere_rows(isa);
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
    const auto isas = available_isas();
    REQUIRE(isas.size() >= 2);
    CHECK(isas[0] == Isa::scalar);
    CHECK(isas[1] == Isa::w128);
    CHECK(std::is_sorted(isas.begin(), isas.end()));
    CHECK(best_isa() == isas.back());
    for (const Isa isa : {Isa::scalar, Isa::w128, Isa::w256, Isa::w512}) {
        CHECK(isa_named(name_of(isa)) == isa);
        CHECK(packed_sphere_rows(isa).empty() == (std::find(isas.begin(), isas.end(), isa) == isas.end()));
    }
    CHECK(name_of(Isa::w256) == "256");
    CHECK_FALSE(isa_named("1024"));
    CHECK_FALSE(isa_named(""));
}

}  // namespace lostbits::test
