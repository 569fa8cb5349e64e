// The loop over a question's numbers, included by one translation unit for each register width.
#pragma once

#include "number/pack.hpp"
#include "number/pack_ops.hpp"

namespace lostbits::test {

template <class Width, class F>
void ask(const PackQuestion<F>& q) {
    using P = Pack<F, Width>;
    for (std::size_t i = 0; i < q.size; i += P::lanes) {
        const P a = P::load(q.a + i), b = P::load(q.b + i), c = P::load(q.c + i);
        pack_op<P>(q.op, a, b, c).store(q.narrow + i);
        wide_pack_op<P>(q.op, a, b, c).store(q.wide + i);
        wide_decision<P>(a, b, c).store(q.decided + i);
        (a < b).store(q.less + i);
        for (std::size_t k = 0; k < P::lanes; ++k) {
            q.any[i + k] = any_of(a < b);
            q.wide_any[i + k] = any_of(Wider<P>::widen(a) < Wider<P>::widen(b));
        }
    }
}

}  // namespace lostbits::test
