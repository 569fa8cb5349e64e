// The packed kernels against the native rows, to the bit: hit, t, near and far, also where hit is false, because the
// same operations on the same numbers leave the same numbers.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <vector>

#include "catch.hpp"
#include "intersect/simd/packed.hpp"
#include "number/draw.hpp"

namespace lostbits::test {

inline constexpr float untouched = -12345;
inline constexpr std::size_t widest = 16;

/// Rays against one solid, as columns.
template <class S>
struct Scene {
    Solid<S> solid;
    std::vector<S> column[6];
    std::vector<S> tmax;  ///< empty: no ray ends

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
    char* memory_ =
        static_cast<char*>(mmap(nullptr, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    std::size_t size_;
};

/// Answers with a margin behind them that no kernel may touch.
template <class S>
struct Answers {
    std::vector<S> t, near, far;
    std::vector<std::uint8_t> hit;
    std::size_t size;

    explicit Answers(std::size_t n) : t(n + widest, untouched), near(t), far(t), hit(n + widest, 77), size(n) {}
    intersect::table::HitBatch<S> batch() {
        return {std::span(t).first(size), std::span(near).first(size), std::span(far).first(size),
                std::span(hit).first(size)};
    }
    [[nodiscard]] bool margin_is_untouched() const {
        for (std::size_t i = size; i < t.size(); ++i)
            if (t[i] != untouched || near[i] != untouched || far[i] != untouched || hit[i] != 77) return false;
        return true;
    }
};

template <class S>
auto kernel_of(const intersect::simd::PackedRow& row) {
    if constexpr (std::same_as<S, float>) return row.f32;
    else return row.f64;
}

template <class S>
Answers<S> run(const intersect::simd::PackedRow& row, const Solid<S>& solid,
               const intersect::table::RayBatch<S>& rays) {
    Answers<S> answers(rays.size());
    kernel_of<S>(row)(rays, solid, answers.batch());
    return answers;
}

template <class S>
Answers<S> run(const intersect::simd::PackedRow& row, const Scene<S>& scene) {
    const auto& c = scene.column;
    return run(row, scene.solid, intersect::table::RayBatch<S>{c[0], c[1], c[2], c[3], c[4], c[5], scene.tmax});
}

template <class S>
bool same(S a, S b) {
    return std::isnan(a) ? std::isnan(b) : std::memcmp(&a, &b, sizeof a) == 0;
}

template <class S>
std::size_t differences(const Answers<S>& a, const Answers<S>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size; ++i)
        count +=
            a.hit[i] != b.hit[i] || !same(a.t[i], b.t[i]) || !same(a.near[i], b.near[i]) || !same(a.far[i], b.far[i]);
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

/// Each form of the shape at every width against its scalar row, on all scenes.
template <class S>
void compare_forms(Shape shape, const std::vector<Scene<S>>& all) {
    const auto native = intersect::simd::packed_rows(intersect::simd::Isa::scalar);
    for (std::size_t form = 0; form < native.size(); ++form) {
        if (intersect::table::intersectors()[form].shape != shape || !kernel_of<S>(native[form])) continue;
        Tally tally;
        std::vector<std::size_t> wrong(intersect::simd::isa_names.size());
        for (const Scene<S>& scene : all) {
            const Answers<S> want = run(native[form], scene);
            tally.note(want);
            for (const intersect::simd::Isa isa : intersect::simd::available_isas())
                wrong[static_cast<std::size_t>(isa)] +=
                    differences(run(intersect::simd::packed_rows(isa)[form], scene), want);
        }
        INFO(native[form].info->name << ": finite hits " << tally.finite_hits << ", misses " << tally.misses << ", NaN "
                                     << tally.not_a_number << " of " << tally.rays);
        CHECK(wrong == std::vector<std::size_t>(intersect::simd::isa_names.size(), 0));
        CHECK(tally.finite_hits > tally.rays / 10);
        CHECK(tally.misses > tally.rays / 20);
        // Of a box, min and max let no NaN through to t, but for the forms that are at fault there.
        if (shape == Shape::sphere) CHECK(tally.not_a_number > tally.rays / 100);
    }
}

/// Every size from nothing to the whole scene, each column ending where a page ends.
template <class S>
void compare_sizes(Shape shape, const Scene<S>& scene) {
    const auto native = intersect::simd::packed_rows(intersect::simd::Isa::scalar);
    for (std::size_t n = 0; n <= scene.size(); ++n) {
        const auto first = [&](const std::vector<S>& all) {
            return Cornered<S>(std::span(all).first(std::min(n, all.size())));
        };
        const auto& c = scene.column;
        const Cornered<S> ox = first(c[0]), oy = first(c[1]), oz = first(c[2]), dx = first(c[3]), dy = first(c[4]),
                          dz = first(c[5]);
        const Cornered<S> tmax = first(scene.tmax);
        const intersect::table::RayBatch<S> rays{ox.span(), oy.span(), oz.span(),  dx.span(),
                                                 dy.span(), dz.span(), tmax.span()};
        for (const intersect::simd::Isa isa : intersect::simd::available_isas())
            for (std::size_t form = 0; form < native.size(); ++form) {
                if (intersect::table::intersectors()[form].shape != shape || !kernel_of<S>(native[form])) continue;
                const Answers<S> got = run(intersect::simd::packed_rows(isa)[form], scene.solid, rays);
                INFO(native[form].info->name << " in " << name_of(isa) << ", " << n << " rays");
                CHECK(differences(got, run(native[form], scene.solid, rays)) == 0);
                CHECK(got.margin_is_untouched());
            }
    }
}

}  // namespace lostbits::test
