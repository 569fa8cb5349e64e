// Number type of the exact check: integers times powers of two, which represent every number of a binary format.
#pragma once

#include <gmp.h>

#include <cmath>
#include <cstdint>
#include <utility>

namespace lostbits::exact {

/// m·2^e.
class Whole {
public:
    Whole() { mpz_init(m_); }
    explicit Whole(double x) {
        int e = 0;
        mpz_init_set_d(m_, std::ldexp(std::frexp(x, &e), 53));
        e_ = x == 0 ? 0 : e - 53;
        strip();
    }
    Whole(const Whole& x) : e_(x.e_) { mpz_init_set(m_, x.m_); }
    Whole(Whole&& x) noexcept : e_(x.e_) {
        mpz_init(m_);
        mpz_swap(m_, x.m_);
    }
    Whole& operator=(Whole x) noexcept {
        mpz_swap(m_, x.m_);
        std::swap(e_, x.e_);
        return *this;
    }
    ~Whole() { mpz_clear(m_); }

    friend int sign(const Whole& a) { return mpz_sgn(a.m_); }
    friend Whole operator-(Whole a) {
        mpz_neg(a.m_, a.m_);
        return a;
    }
    friend Whole operator*(const Whole& a, const Whole& b) {
        Whole c;
        mpz_mul(c.m_, a.m_, b.m_);
        c.e_ = a.e_ + b.e_;
        return c;
    }
    friend Whole operator+(const Whole& a, const Whole& b) {
        if (mpz_sgn(a.m_) == 0) return b;
        if (mpz_sgn(b.m_) == 0) return a;
        if (a.e_ < b.e_) return b + a;
        Whole c;
        mpz_mul_2exp(c.m_, a.m_, static_cast<mp_bitcnt_t>(a.e_ - b.e_));
        mpz_add(c.m_, c.m_, b.m_);
        c.e_ = b.e_;
        return c;
    }
    friend Whole operator-(const Whole& a, const Whole& b) { return a + -b; }
    [[nodiscard]] Whole scaled(std::int64_t e) const {
        Whole c = *this;
        c.e_ += e;
        return c;
    }

private:
    /// Without zeros at the end, so that sums of small numbers stay small.
    void strip() {
        if (mpz_sgn(m_) == 0) return;
        const mp_bitcnt_t zeros = mpz_scan1(m_, 0);
        mpz_fdiv_q_2exp(m_, m_, zeros);
        e_ += static_cast<std::int64_t>(zeros);
    }
    mpz_t m_;
    std::int64_t e_ = 0;
};

}  // namespace lostbits::exact
