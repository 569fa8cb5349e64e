// The forms under other flags: they are what they are said to be, and nothing else in the process is.
#include <cmath>
#include <random>

#include "catch.hpp"
#include "intersect/simd/variants.hpp"

namespace lostbits::test::test_variants {

using intersect::simd::Variant;
using intersect::table::Intersector;

namespace {

template <class S>
struct Batch {
    std::vector<S> in[6], t, near, far;
    std::vector<std::uint8_t> hit;

    explicit Batch(std::size_t n) : t(n), near(n), far(n), hit(n) {
        std::mt19937_64 random(11);
        const auto unit = [&random] { return static_cast<S>(static_cast<double>(random() >> 11) * 0x1p-52 - 1); };
        for (std::size_t i = 0; i < n; ++i) {
            for (int c = 0; c < 6; ++c) in[c].push_back(unit());
            in[2].back() -= S(4);
            in[5].back() = S(4) + unit();
        }
    }
    void run(const Intersector& row, std::size_t from, std::size_t size) {
        const Solid<S> solid = solid_around<S>(row.shape, {S(0), S(0), S(0)}, S(1));
        const auto part = [&](std::vector<S>& v) { return std::span(v).subspan(from, size); };
        const intersect::table::RayBatch<S> rays{part(in[0]), part(in[1]), part(in[2]),
                                                 part(in[3]), part(in[4]), part(in[5])};
        const intersect::table::HitBatch<S> hits{part(t), part(near), part(far), std::span(hit).subspan(from, size)};
        if constexpr (sizeof(S) == sizeof(float)) row.native32(rays, solid, hits);
        else row.native64(rays, solid, hits);
    }
};

template <class S>
void any_size(const Intersector& row) {
    constexpr std::size_t most = 41;
    Batch<S> whole(most);
    whole.run(row, 0, most);
    for (const std::size_t size : {1, 3, 7, 8, 9, 16, 31}) {
        Batch<S> part(most);
        part.run(row, 2, size);
        for (std::size_t i = 0; i < most; ++i) {
            const bool inside = i >= 2 && i < 2 + size;
            CHECK(part.hit[i] == (inside ? whole.hit[i] : 0));
            if (!inside) CHECK(part.t[i] == 0);
            else if (whole.hit[i] != 0) CHECK(part.t[i] == whole.t[i]);
        }
    }
}

/// Rays on which two rows answer with other bits, or decide otherwise.
std::size_t differing(const Intersector& a, const Intersector& b) {
    Batch<float> one(4096), two(4096);
    one.run(a, 0, 4096);
    two.run(b, 0, 4096);
    std::size_t n = 0;
    for (std::size_t i = 0; i < 4096; ++i) n += one.hit[i] != two.hit[i] || (one.hit[i] != 0 && one.t[i] != two.t[i]);
    return n;
}

std::size_t number_of(std::string_view form) {
    std::size_t i = 0;
    while (intersect::table::intersectors()[i].info->name != form) ++i;
    return i;
}

}  // namespace

TEST_CASE("variants have the rows of the table under names of their own", "[intersect][variants]") {
    if (intersect::simd::variants().empty()) WARN("no variant runs here");
    for (const Variant& v : intersect::simd::variants()) {
        REQUIRE(v.rows.size() == intersect::table::intersectors().size());
        for (std::size_t i = 0; i < v.rows.size(); ++i) {
            const Intersector& native = intersect::table::intersectors()[i];
            CHECK(v.rows[i].info->name == std::string(native.info->name) + "+" + std::string(v.name));
            CHECK(v.rows[i].shape == native.shape);
            CHECK((v.rows[i].native64 == nullptr) == (native.native64 == nullptr));
        }
    }
}

TEST_CASE("variants take batches of any size and touch nothing beside them", "[intersect][variants]") {
    for (const Variant& v : intersect::simd::variants()) {
        for (const char* form : {"sphere.unified", "box.signs"}) {
            any_size<float>(v.rows[number_of(form)]);
            any_size<double>(v.rows[number_of(form)]);
        }
    }
}

TEST_CASE("other flags give other bits, and nearly the same answers", "[intersect][variants]") {
    for (const Variant& v : intersect::simd::variants()) {
        // Sums of products contract and reassociate.
        const std::size_t i = number_of("sphere.schoolbook");
        CHECK(differing(v.rows[i], intersect::table::intersectors()[i]) > 100);
        Batch<float> fast(4096), right(4096);
        fast.run(v.rows[i], 0, 4096);
        right.run(intersect::table::intersectors()[i], 0, 4096);
        std::size_t decided_otherwise = 0, both_hit = 0;
        for (std::size_t r = 0; r < 4096; ++r) {
            decided_otherwise += fast.hit[r] != right.hit[r];
            if (!fast.hit[r] || !right.hit[r]) continue;
            ++both_hit;
            CHECK(fast.t[r] == Approx(right.t[r]).epsilon(1e-2));
        }
        CHECK(decided_otherwise < 8);
        CHECK(both_hit > 0);
    }
}

TEST_CASE("a program that holds code of -ffast-math still has subnormal numbers", "[intersect][variants]") {
    volatile float small = 0x1p-126F, half = 0.5F;
    volatile double tiny = 0x1p-1022, half64 = 0.5;
    CHECK(small * half == 0x1p-127F);
    CHECK(tiny * half64 == 0x1p-1023);
    CHECK(std::isnan(std::sqrt(-small)));
    for (const Variant& v : intersect::simd::variants()) {
        Batch<float> batch(64);
        batch.run(v.rows[0], 0, 64);
    }
    CHECK(small * half == 0x1p-127F);
}

}  // namespace lostbits::test::test_variants
