// Exact sums and products of doubles of any magnitude, which decide when words would overflow or underflow. They are
// scalar and slow, some ten microseconds a ray at worst. `Tag` is the number type of the formula that uses them; for
// packs it keeps the code of one instruction set apart from another's (number/pack.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace lostbits::number::wide {

/// m·2^e with a double m and any e, accurate to the last places of a double.
template <class Tag>
struct ScaledDouble {
    double m = 0;
    int e = 0;

    ScaledDouble() = default;
    explicit ScaledDouble(double x, int exponent = 0) {
        m = std::frexp(x, &e);
        e += exponent;
    }
    /// Rounded once more if the result is subnormal.
    [[nodiscard]] double value() const { return std::ldexp(m, e); }
    friend ScaledDouble operator+(const ScaledDouble& a, const ScaledDouble& b) {
        if (a.m == 0 || b.m == 0) return a.m == 0 ? b : a;
        const int top_exponent = std::max(a.e, b.e);
        return ScaledDouble(std::ldexp(a.m, a.e - top_exponent) + std::ldexp(b.m, b.e - top_exponent), top_exponent);
    }
    friend ScaledDouble operator/(const ScaledDouble& a, const ScaledDouble& b) {
        return ScaledDouble(a.m / b.m, a.e - b.e);
    }
    friend ScaledDouble abs(const ScaledDouble& a) { return ScaledDouble(std::fabs(a.m), a.e); }
    friend ScaledDouble sqrt(const ScaledDouble& a) {
        const int odd = a.e & 1;
        return ScaledDouble(std::sqrt(std::ldexp(a.m, odd)), (a.e - odd) / 2);
    }
};

/// ±Σ limb[i]·2^(32(first + i)). A finite double lies between 2^-1074 and 2^1024, so a sum of products of four doubles,
/// or of four sums of two doubles, has its bits between 2^-4296 and 2^4110: 264 limbs, and one at either end for the
/// alignment.
template <class Tag>
class Dyadic {
public:
    Dyadic() = default;
    Dyadic(const Dyadic& x) : first_(x.first_), size_(x.size_), negative_(x.negative_) { copy_limbs(x); }
    Dyadic& operator=(const Dyadic& x) {
        first_ = x.first_;
        size_ = x.size_;
        negative_ = x.negative_;
        copy_limbs(x);
        return *this;
    }
    /// Infinity is converted to the largest number, NaN to zero.
    explicit Dyadic(double x) : negative_(std::signbit(x)) {
        if (!(std::fabs(x) > 0)) return;
        x = std::min(std::fabs(x), std::numeric_limits<double>::max());
        int exponent = 0;
        const auto whole = static_cast<std::uint64_t>(std::ldexp(std::frexp(x, &exponent), 53));
        exponent -= 53;
        first_ = exponent >= 0 ? exponent / 32 : -((31 - exponent) / 32);
        const int shift = exponent - 32 * first_;
        const std::uint64_t low = (whole & 0xffffffffU) << shift, high = ((whole >> 32) << shift) + (low >> 32);
        limbs_[0] = static_cast<std::uint32_t>(low);
        limbs_[1] = static_cast<std::uint32_t>(high);
        limbs_[2] = static_cast<std::uint32_t>(high >> 32);
        size_ = 3;
        trim();
    }

    [[nodiscard]] int sign() const { return size_ == 0 ? 0 : negative_ ? -1 : 1; }
    /// Value computed from the three highest limbs, accurate to the last place of a double.
    [[nodiscard]] ScaledDouble<Tag> scaled() const {
        double leading = 0;
        const int lowest = std::max(size_ - 3, 0);
        for (int i = size_; i-- > lowest;) leading = leading * 0x1p32 + limbs_[i];
        return ScaledDouble<Tag>(negative_ ? -leading : leading, 32 * (first_ + lowest));
    }

    friend Dyadic operator-(Dyadic a) {
        a.negative_ = !a.negative_;
        return a;
    }
    friend Dyadic operator+(const Dyadic& a, const Dyadic& b) {
        if (a.size_ == 0 || b.size_ == 0) return a.size_ == 0 ? b : a;
        if (a.negative_ == b.negative_) return add_magnitudes(a, b, 1);
        const int order = compare_magnitudes(a, b);
        return order == 0 ? Dyadic() : order > 0 ? add_magnitudes(a, b, -1) : add_magnitudes(b, a, -1);
    }
    friend Dyadic operator-(const Dyadic& a, const Dyadic& b) { return a + -b; }
    friend Dyadic operator*(const Dyadic& a, const Dyadic& b) {
        Dyadic r;
        if (a.size_ == 0 || b.size_ == 0) return r;
        r.negative_ = a.negative_ != b.negative_;
        r.first_ = a.first_ + b.first_;
        r.size_ = a.size_ + b.size_;

        for (int i = 0; i < r.size_; ++i) r.limbs_[i] = 0;
        for (int i = 0; i < a.size_; ++i) {
            std::uint64_t carry = 0;
            for (int j = 0; j < b.size_; ++j) {
                std::uint32_t& limb = r.limbs_[i + j];
                carry += std::uint64_t{a.limbs_[i]} * b.limbs_[j] + limb;
                limb = static_cast<std::uint32_t>(carry);
                carry >>= 32;
            }
            r.limbs_[i + b.size_] = static_cast<std::uint32_t>(carry);
        }
        r.trim();
        return r;
    }

private:
    static constexpr int max_limbs = 272;

    /// Copies only the limbs in use: most numbers have a few.
    void copy_limbs(const Dyadic& x) {
        for (int i = 0; i < x.size_; ++i) limbs_[i] = x.limbs_[i];
    }

    [[nodiscard]] int end() const { return first_ + size_; }
    /// The limb at 2^(32 index).
    [[nodiscard]] std::uint32_t limb_at(int index) const {
        return index < first_ || index >= end() ? 0 : limbs_[index - first_];
    }
    static int compare_magnitudes(const Dyadic& a, const Dyadic& b) {
        for (int index = std::max(a.end(), b.end()); index-- > std::min(a.first_, b.first_);)
            if (a.limb_at(index) != b.limb_at(index)) return a.limb_at(index) > b.limb_at(index) ? 1 : -1;
        return 0;
    }
    /// |a| ± |b| with the sign of a; for a difference |a| > |b|.
    static Dyadic add_magnitudes(const Dyadic& a, const Dyadic& b, int sign) {
        Dyadic r;
        r.negative_ = a.negative_;
        r.first_ = std::min(a.first_, b.first_);
        r.size_ = std::max(a.end(), b.end()) + 1 - r.first_;
        std::int64_t carry = 0;
        for (int i = 0; i < r.size_; ++i) {
            carry += std::int64_t{a.limb_at(r.first_ + i)} + sign * std::int64_t{b.limb_at(r.first_ + i)};
            r.limbs_[i] = static_cast<std::uint32_t>(carry & 0xffffffff);
            carry >>= 32;
        }
        r.trim();
        return r;
    }
    /// Removes zeros at either end, so that products stay short.
    void trim() {
        while (size_ > 0 && limbs_[size_ - 1] == 0) --size_;
        int zero_count = 0;
        while (zero_count < size_ && limbs_[zero_count] == 0) ++zero_count;
        if (zero_count == 0) return;
        for (int i = zero_count; i < size_; ++i) limbs_[i - zero_count] = limbs_[i];
        first_ += zero_count;
        size_ -= zero_count;
    }

    std::uint32_t limbs_[max_limbs];
    int first_ = 0, size_ = 0;
    bool negative_ = false;
};

}  // namespace lostbits::number::wide
