// Operation that only a copy of number/tape.hpp lists; see ghost_operation.cmake.
#include "measure/attribution/operation_rows.hpp"

namespace lostbits::measure::attribution {

#ifdef GHOST_IS_DESCRIBED
template <>
struct Operation<TapeOp::ghost> {
    static constexpr OperationText text{.precedence = 4,
                                        .plain = "ghost($1, $2)",
                                        .c = "ghost$f($1, $2)",
                                        .missing_in_c = "a ghost",
#ifdef GHOST_HAS_ALL_TEXTS
                                        .fpcore = "(ghost $1 $2)"
#endif
    };
};
#endif

}  // namespace lostbits::measure::attribution

#include "measure/attribution/operations.hpp"
