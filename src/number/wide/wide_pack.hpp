// Doubles for formulas over a pack of floats that compute in double inside.
#pragma once

#include "number/pack.hpp"

namespace lostbits::number::wide {

/// The doubles for a pack of floats: the same number of lanes, in twice as many registers.
template <class Width>
class WidePack {
public:
    using Half = Pack<double, Width>;
    using Narrow = Pack<float, Width>;

    /// A decision in each lane, which converts to a decision about the floats.
    struct Lanes {
        PackMask<double, Width> low, high;

        friend Lanes operator&&(const Lanes& a, const Lanes& b) { return {a.low && b.low, a.high && b.high}; }
        friend Lanes operator||(const Lanes& a, const Lanes& b) { return {a.low || b.low, a.high || b.high}; }
        friend Lanes operator!(const Lanes& a) { return {!a.low, !a.high}; }
        friend bool any_of(const Lanes& a) { return any_of(a.low) || any_of(a.high); }
        operator PackMask<float, Width>() const { return select(*this, WidePack(1), WidePack(0)).narrow() > Narrow(0); }
    };

    WidePack() = default;
    explicit WidePack(int x) : low_(x), high_(x) {}
    explicit WidePack(double x) : low_(x), high_(x) {}
    WidePack(const Half& low, const Half& high) : low_(low), high_(high) {}
    explicit WidePack(const Narrow& x) {
        if constexpr (has_pack_registers) {
            low_ = Half(typename Half::Register(pack_low(x.registers())));
            high_ = Half(typename Half::Register(pack_high(x.registers())));
        } else {
            double lanes[Narrow::lanes];
            for (std::size_t k = 0; k < Narrow::lanes; ++k) lanes[k] = x.registers()[k];
            low_ = Half::load(lanes);
            high_ = Half::load(lanes + Half::lanes);
        }
    }
    /// Converts to floats; each lane is rounded once.
    [[nodiscard]] Narrow narrow() const {
        if constexpr (has_pack_registers) {
            return Narrow(typename Narrow::Register(pack_narrow(low_.registers(), high_.registers())));
        } else {
            float lanes[Narrow::lanes];
            for (std::size_t k = 0; k < Narrow::lanes; ++k)
                lanes[k] = static_cast<float>((k < Half::lanes ? low_ : high_).registers()[k % Half::lanes]);
            return Narrow::load(lanes);
        }
    }

    friend WidePack operator+(const WidePack& a, const WidePack& b) { return {a.low_ + b.low_, a.high_ + b.high_}; }
    friend WidePack operator-(const WidePack& a, const WidePack& b) { return {a.low_ - b.low_, a.high_ - b.high_}; }
    friend WidePack operator*(const WidePack& a, const WidePack& b) { return {a.low_ * b.low_, a.high_ * b.high_}; }
    friend WidePack operator/(const WidePack& a, const WidePack& b) { return {a.low_ / b.low_, a.high_ / b.high_}; }
    friend WidePack operator-(const WidePack& a) { return {-a.low_, -a.high_}; }
    WidePack& operator+=(const WidePack& b) { return *this = *this + b; }
    WidePack& operator-=(const WidePack& b) { return *this = *this - b; }
    WidePack& operator*=(const WidePack& b) { return *this = *this * b; }

    friend Lanes operator<(const WidePack& a, const WidePack& b) { return {a.low_ < b.low_, a.high_ < b.high_}; }
    friend Lanes operator<=(const WidePack& a, const WidePack& b) { return {a.low_ <= b.low_, a.high_ <= b.high_}; }
    friend Lanes operator>(const WidePack& a, const WidePack& b) { return {a.low_ > b.low_, a.high_ > b.high_}; }
    friend Lanes operator>=(const WidePack& a, const WidePack& b) { return {a.low_ >= b.low_, a.high_ >= b.high_}; }

    friend WidePack sqrt(const WidePack& a) { return {sqrt(a.low_), sqrt(a.high_)}; }
    friend WidePack abs(const WidePack& a) { return {abs(a.low_), abs(a.high_)}; }
    friend WidePack copysign(const WidePack& a, const WidePack& b) {
        return {copysign(a.low_, b.low_), copysign(a.high_, b.high_)};
    }
    friend WidePack fma(const WidePack& a, const WidePack& b, const WidePack& c) {
        return {fma(a.low_, b.low_, c.low_), fma(a.high_, b.high_, c.high_)};
    }
    friend WidePack select(const Lanes& mask, const WidePack& a, const WidePack& b) {
        return {select(mask.low, a.low_, b.low_), select(mask.high, a.high_, b.high_)};
    }
    friend WidePack next_up(const WidePack& a) { return {next_up(a.low_), next_up(a.high_)}; }
    friend WidePack next_down(const WidePack& a) { return {next_down(a.low_), next_down(a.high_)}; }

private:
    Half low_, high_;
};

}  // namespace lostbits::number::wide

template <class Width>
struct lostbits::Wider<lostbits::Pack<float, Width>> {
    using type = number::wide::WidePack<Width>;
    static type widen(const Pack<float, Width>& x) { return type(x); }
    static Pack<float, Width> narrow(const type& x) { return x.narrow(); }
};

static_assert(lostbits::Number<lostbits::number::wide::WidePack<lostbits::Registers<16>>>);
