// The loop over the numbers of a request; compiled once for each register width.
#include "number/pack_ops.hpp"
#include "number/wide/wide_pack.hpp"
#include "number/width.hpp"

namespace lostbits::test {
namespace {

template <class F>
void ask(const PackQuestion<F>& q) {
    using P = Pack<F, BuildRegisters>;
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

}  // namespace

void LOSTBITS_WITH_WIDTH_SUFFIX(ask)(const PackQuestion<float>& question) { ask(question); }
void LOSTBITS_WITH_WIDTH_SUFFIX(ask)(const PackQuestion<double>& question) { ask(question); }

}  // namespace lostbits::test
