// Pack compared with the scalar numbers: every operation, every register width of this machine, lane by lane to the
// bit. The lanes hold different numbers, so swapped or shared lanes are detected.
#include <bit>
#include <string>
#include <vector>

#include "catch.hpp"
#include "intersect/simd/packed.hpp"
#include "number/draw.hpp"
#include "number/pack_ops.hpp"

namespace lostbits::test {

using intersect::simd::Isa;

namespace {

template <class F>
using Ask = void (*)(const PackQuestion<F>&);

template <class F>
Ask<F> ask_of(Isa isa) {
    switch (isa) {
        case Isa::w128: return ask_w128;
#if defined(__x86_64__)
        case Isa::w256: return ask_w256;
        case Isa::w512: return ask_w512;
#endif
        default: return nullptr;
    }
}

template <class F>
std::string hex(F x) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "%a", static_cast<double>(x));
    return buffer;
}

/// Triples of every special number, in turn and against each other, then numbers drawn for each operation's hard cases.
template <class F>
struct Numbers {
    std::vector<F> a, b, c;

    explicit Numbers(Random& random) {
        const FloatFormat f = sizeof(F) == 4 ? binary32 : binary64;
        const F tiny = static_cast<F>(std::ldexp(1.0, f.emin - f.precision + 1)),
                normal = static_cast<F>(std::ldexp(1.0, f.emin));
        const F most = std::numeric_limits<F>::max();
        std::vector<F> special;
        for (const F x : {F(0), F(1), F(3), F(1) / F(3), tiny, 2 * tiny, normal - tiny, normal, normal + tiny, most,
                          most / 2, F(HUGE_VAL), F(NAN)})
            for (const F signed_x : {x, -x}) special.push_back(signed_x);
        for (const F x : special)
            for (const F y : special)
                for (const F z : special) add(x, y, z);
        for (const Op op : every_op)
            for (int i = 0; i < 4000; ++i) {
                const auto [x, y, z] = draw_operands(random, f, op);
                add(static_cast<F>(x), static_cast<F>(y), static_cast<F>(z));
            }
        while (a.size() % 16 != 0) add(F(1), F(2), F(3));
    }
    void add(F x, F y, F z) {
        a.push_back(x);
        b.push_back(y);
        c.push_back(z);
    }
};

template <class F>
struct Answers {
    std::vector<F> narrow, wide, decided;
    std::vector<std::uint8_t> less, any, wide_any;

    Answers(Ask<F> ask, int op, const Numbers<F>& x) {
        const std::size_t n = x.a.size();
        for (auto* v : {&narrow, &wide, &decided}) v->assign(n, F(-12345));
        const auto masks = std::make_unique<bool[]>(3 * n);
        ask({op, x.a.data(), x.b.data(), x.c.data(), narrow.data(), wide.data(), decided.data(), &masks[0], &masks[n],
             &masks[2 * n], n});
        less.assign(&masks[0], &masks[n]);
        any.assign(&masks[n], &masks[2 * n]);
        wide_any.assign(&masks[2 * n], &masks[3 * n]);
    }
};

struct Wrong {
    int count = 0;
    std::string first;

    template <class F>
    void unless_same(F got, F want, const char* what, const Numbers<F>& x, std::size_t i) {
        using Bits = std::conditional_t<sizeof(F) == 4, std::uint32_t, std::uint64_t>;
        const bool same = std::isnan(want) ? std::isnan(got) : std::bit_cast<Bits>(got) == std::bit_cast<Bits>(want);
        if (same || count++ > 0) return;
        first = std::string(what) + " gives " + hex(got) + " instead of " + hex(want) + " for a = " + hex(x.a[i]) +
                ", b = " + hex(x.b[i]) + ", c = " + hex(x.c[i]);
    }
};

template <class F>
void compare(Isa isa, const Numbers<F>& x) {
    const std::size_t n = x.a.size(), lanes = bytes_of(isa) / sizeof(F);
    for (int op = 0; op < pack_op_count; ++op) {
        const Answers<F> got(ask_of<F>(isa), op, x);
        Wrong wrong;
        int wrong_masks = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const F a = x.a[i], b = x.b[i], c = x.c[i];
            wrong.unless_same(got.narrow[i], pack_op(op, a, b, c), "the pack", x, i);
            wrong.unless_same(got.wide[i], wide_pack_op(op, a, b, c), "the wider pack", x, i);
            wrong.unless_same(got.decided[i], wide_decision(a, b, c), "a decision of the wider pack", x, i);
            wrong_masks += got.less[i] != (a < b);
            bool any = false;
            for (std::size_t k = 0; k < lanes; ++k)
                any = any || x.a[i / lanes * lanes + k] < x.b[i / lanes * lanes + k];
            wrong_masks += got.any[i] != any;
            wrong_masks += got.wide_any[i] != any;
        }
        INFO(pack_op_names[op] << " in " << name_of(isa) << " bits, " << sizeof(F) * 8
                               << "-bit numbers: " << wrong.first);
        CHECK(wrong.count == 0);
        CHECK(wrong_masks == 0);
    }
}

}  // namespace

TEST_CASE("every lane of a pack has the bits of the scalar operation", "[number][pack]") {
    Random random(256);
    const Numbers<float> floats(random);
    const Numbers<double> doubles(random);
    REQUIRE(floats.a.size() > 60000);
    for (const Isa isa : intersect::simd::available_isas()) {
        if (isa == Isa::scalar) continue;
        REQUIRE(ask_of<float>(isa) != nullptr);
        compare(isa, floats);
        compare(isa, doubles);
    }
}

TEST_CASE("comparing lanes detects a wrong sign of zero, a wrong last bit and a NaN", "[number][pack]") {
    Random random(1);
    const Numbers<float> x(random);
    Wrong wrong;
    wrong.unless_same(0.0f, 0.0f, "", x, 0);
    wrong.unless_same(std::nanf("1"), -std::nanf("2"), "", x, 0);
    CHECK(wrong.count == 0);
    wrong.unless_same(0.0f, -0.0f, "", x, 0);
    wrong.unless_same(1.0f, std::nextafter(1.0f, 2.0f), "", x, 0);
    wrong.unless_same(1.0f, std::nanf(""), "", x, 0);
    wrong.unless_same(std::nanf(""), 1.0f, "", x, 0);
    CHECK(wrong.count == 4);
}

TEST_CASE("fma in a pack is fused", "[number][pack]") {
    // (1 + 2^-12)² = 1 + 2^-11 + 2^-24; the product alone rounds the last term away, and −(1 + 2^-11) leaves it.
    const float a = 1 + 0x1p-12f, c = -(1 + 0x1p-11f);
    Random random(1);
    Numbers<float> x(random);
    std::fill(x.a.begin(), x.a.end(), a);
    std::fill(x.b.begin(), x.b.end(), a);
    std::fill(x.c.begin(), x.c.end(), c);
    for (const Isa isa : intersect::simd::available_isas()) {
        if (isa == Isa::scalar) continue;
        INFO(name_of(isa));
        const Answers<float> got(ask_of<float>(isa), 9, x);
        CHECK(got.narrow[0] == 0x1p-24f);
        CHECK(got.narrow == std::vector<float>(x.a.size(), 0x1p-24f));
    }
}

}  // namespace lostbits::test
