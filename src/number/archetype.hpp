// Archetype: the smallest legal number, which checks that a formula obeys the rules. It is only compiled against, never
// run: an `if` on a mask, a double literal, a libm call or a default-constructed value in a formula does not compile.
#pragma once

#include "number/concept.hpp"

namespace lostbits {

class Archetype {
public:
    class Mask {
    public:
        friend Mask operator&&(const Mask&, const Mask&);
        friend Mask operator||(const Mask&, const Mask&);
        friend Mask operator!(const Mask&);
        friend bool any_of(const Mask&);

    private:
        friend class Archetype;
        Mask() = default;
    };

    explicit Archetype(int);
    Archetype(double) = delete;  // constants are whole numbers: write T(1) / T(2) for 0.5
    Archetype(float) = delete;

    Archetype& operator+=(const Archetype&);
    Archetype& operator-=(const Archetype&);
    Archetype& operator*=(const Archetype&);
    friend Archetype operator+(const Archetype&, const Archetype&);
    friend Archetype operator-(const Archetype&, const Archetype&);
    friend Archetype operator*(const Archetype&, const Archetype&);
    friend Archetype operator/(const Archetype&, const Archetype&);
    friend Archetype operator-(const Archetype&);
    friend Mask operator<(const Archetype&, const Archetype&);
    friend Mask operator<=(const Archetype&, const Archetype&);
    friend Mask operator>(const Archetype&, const Archetype&);
    friend Mask operator>=(const Archetype&, const Archetype&);
    friend Archetype sqrt(const Archetype&);
    friend Archetype fma(const Archetype&, const Archetype&, const Archetype&);
    friend Archetype abs(const Archetype&);
    friend Archetype copysign(const Archetype&, const Archetype&);
    friend Archetype next_up(const Archetype&);
    friend Archetype next_down(const Archetype&);
    friend Archetype select(const Mask&, const Archetype&, const Archetype&);
};

static_assert(Number<Archetype>);

}  // namespace lostbits
