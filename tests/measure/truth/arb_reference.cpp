#include "measure/truth/arb_reference.hpp"

namespace lostbits::testing {

ArbReference::ArbReference() {
    for (int i = 0; i < 3; ++i) {
        arb_init(f_[i]);
        arb_init(d_[i]);
    }
    for (arb_ptr x : {r_, o_, a_, h_, c_, disc_, t_}) arb_init(x);
}

ArbReference::~ArbReference() {
    for (int i = 0; i < 3; ++i) {
        arb_clear(f_[i]);
        arb_clear(d_[i]);
    }
    for (arb_ptr x : {r_, o_, a_, h_, c_, disc_, t_}) arb_clear(x);
}

void ArbReference::dot(arb_t to, const arb_t* x, const arb_t* y, long bits) {
    arb_mul(to, x[0], y[0], bits);
    arb_addmul(to, x[1], y[1], bits);
    arb_addmul(to, x[2], y[2], bits);
}

// An exact zero is recognised as such: with enough bits every sum and product is exact and its ball is a point.
ArbReference::Decision ArbReference::decide(long bits) {
    const auto decided = [](const arb_t x) { return arb_is_zero(x) != 0 || arb_contains_zero(x) == 0; };
    dot(c_, f_, f_, bits);
    arb_submul(c_, r_, r_, bits);
    dot(h_, f_, d_, bits);
    dot(a_, d_, d_, bits);
    arb_mul(disc_, h_, h_, bits);
    arb_submul(disc_, a_, c_, bits);
    if (!decided(c_)) return Decision::undecided;
    on_surface_ = arb_is_zero(c_) != 0;
    inside_ = arb_is_negative(c_) != 0;
    if (on_surface_ || inside_) return Decision::hit;
    if (arb_is_nonnegative(h_) != 0 || arb_is_negative(disc_) != 0) return Decision::miss;
    return decided(h_) && decided(disc_) ? Decision::hit : Decision::undecided;
}

// t = (−h ∓ √(h² − a c))/a
void ArbReference::root(long bits) {
    arb_sqrt(t_, disc_, bits);
    if (!inside_) arb_neg(t_, t_);
    arb_sub(t_, t_, h_, bits);
    arb_div(t_, t_, a_, bits);
}

ArbReference::Answer ArbReference::find(const Ray<double>& ray, const Sphere<double>& sphere) {
    for (int i = 0; i < 3; ++i) {
        arb_set_d(f_[i], ray.origin[i]);
        arb_set_d(o_, sphere.centre[i]);
        arb_sub(f_[i], f_[i], o_, ARF_PREC_EXACT);
        arb_set_d(d_[i], ray.direction[i]);
    }
    arb_set_d(r_, sphere.radius);

    Answer answer;
    arf_t low, high;
    arf_init(low);
    arf_init(high);
    // Four times the 8400 bits within which everything but root and quotient is exact.
    for (answer.bits = 64; answer.bits <= 40'000; answer.bits *= 2) {
        answer.decision = decide(answer.bits);
        if (answer.decision == Decision::undecided) continue;
        if (answer.decision == Decision::miss) break;
        if (on_surface_) {
            answer.rounded = true;
            break;
        }
        root(answer.bits);
        if (arb_is_finite(t_) == 0) continue;
        if (arb_is_exact(t_) != 0) {
            answer.t = arf_get_d(arb_midref(t_), ARF_RND_NEAR);
            answer.rounded = true;
            break;
        }
        arb_get_lbound_arf(low, t_, answer.bits);
        arb_get_ubound_arf(high, t_, answer.bits);
        if (arf_sgn(low) < 0) continue;  // not yet told from zero, whose sign would differ
        answer.t = arf_get_d(low, ARF_RND_NEAR);
        answer.rounded = answer.t == arf_get_d(high, ARF_RND_NEAR);
        if (answer.rounded) break;
    }
    arf_clear(low);
    arf_clear(high);
    return answer;
}

}  // namespace lostbits::testing
