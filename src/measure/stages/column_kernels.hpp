// Kernels of column programs, for registers of one width. A column program proves the decisions for many rays at once:
// each column holds one number of every ray, and each instruction computes new columns from others. A kernel runs one
// instruction over all rays, a pack (one register of rays) at a time, with numbers that carry their error bound
// (`RunningError`).
#pragma once

#include <array>
#include <cstring>
#include <type_traits>
#include <utility>

#include "geometry/recorded_root.hpp"
#include "measure/stages/problem.hpp"
#include "measure/stages/raw_stages.hpp"
#include "measure/stages/span_hits.hpp"
#include "number/pack.hpp"

namespace lostbits::measure::stages {

using number::wide::bounded_operand_count;
using number::wide::column_count_of;
using number::wide::ColumnOperation;
using number::wide::exact_operands_with_kernel;

/// Mask of a decision, which columns store as registers hold it: all bits of a lane are set, or none.
template <class P>
mask_t<P> mask_of(const P& x) {
    return mask_t<P>(x.words());
}

/// The columns of an instruction. The pointers are copied into local variables: a store to a column might otherwise
/// change a pointer in memory, and the compiler would load every pointer again after each store. If every operand moves
/// from pack to pack, as in most instructions, one index serves all of them.
template <class P, std::size_t count, bool all_move>
class ColumnCursor {
public:
    ColumnCursor(double* scratch, const ColumnOperand* operands) {
        for (std::size_t k = 0; k < count; ++k) {
            columns_[k] = scratch + operands[k].offset;
            steps_[k] = operands[k].step;
        }
    }
    void move_to(std::size_t pack) { pack_ = pack; }

    [[nodiscard]] P word(std::size_t k) const { return P::load(address(k)); }
    [[nodiscard]] mask_t<P> mask(std::size_t k) const { return mask_of(word(k)); }
    void store(std::size_t k, const P& x) const { x.store(address(k)); }
    void store(std::size_t k, const mask_t<P>& x) const { P(typename P::Words(x.registers())).store(address(k)); }

private:
    [[nodiscard]] double* address(std::size_t k) const {
        return columns_[k] + pack_ * (all_move ? P::lanes : steps_[k]);
    }

    double* columns_[count];
    std::size_t steps_[count], pack_ = 0;
};

/// Calls `Step::apply(cursor)` for each pack. (This function is flattened itself: GCC keeps calls in a lambda of a
/// flattened function.)
template <class P, class Step, bool all_move>
[[gnu::flatten]] void run_packs(double* scratch, const ColumnOperand* operands, std::size_t pack_count) {
    ColumnCursor<P, Step::column_count, all_move> cursor(scratch, operands);
    for (std::size_t i = 0; i < pack_count; ++i) {
        cursor.move_to(i);
        Step::apply(cursor);
    }
}
template <class P, class Step>
void run_step(double* scratch, const ColumnOperand* operands, std::size_t pack_count) {
    bool all_move = true;
    for (std::size_t k = 0; k < Step::column_count; ++k) all_move = all_move && operands[k].step != 0;
    if (all_move) run_packs<P, Step, true>(scratch, operands, pack_count);
    else run_packs<P, Step, false>(scratch, operands, pack_count);
}

template <ColumnOperation operation, class P>
struct WordStep {
    static constexpr std::size_t column_count = column_count_of(operation);
    template <class Cursor>
    [[gnu::always_inline]] static void apply(const Cursor& cursor) {
        using enum ColumnOperation;
        using lostbits::abs;
        using lostbits::max;

        // Arithmetic
        if constexpr (operation == add) cursor.store(2, cursor.word(0) + cursor.word(1));
        else if constexpr (operation == subtract) cursor.store(2, cursor.word(0) - cursor.word(1));
        else if constexpr (operation == multiply) cursor.store(2, cursor.word(0) * cursor.word(1));
        else if constexpr (operation == divide) cursor.store(2, cursor.word(0) / cursor.word(1));
        else if constexpr (operation == negate) cursor.store(1, -cursor.word(0));
        else if constexpr (operation == absolute) cursor.store(1, abs(cursor.word(0)));
        else if constexpr (operation == maximum) cursor.store(2, max(cursor.word(0), cursor.word(1)));
        else if constexpr (operation == ColumnOperation::power_at_most) cursor.store(1, binade(cursor.word(0)));
        else if constexpr (operation == choose) cursor.store(3, select(cursor.mask(0), cursor.word(1), cursor.word(2)));

        // Decisions
        else if constexpr (operation == less) cursor.store(2, cursor.word(0) < cursor.word(1));
        else if constexpr (operation == at_most) cursor.store(2, cursor.word(0) <= cursor.word(1));
        else if constexpr (operation == mask_and) cursor.store(2, cursor.mask(0) && cursor.mask(1));
        else if constexpr (operation == mask_or) cursor.store(2, cursor.mask(0) || cursor.mask(1));
        else if constexpr (operation == mask_not) cursor.store(1, !cursor.mask(0));

        // Operations of the stages
        else if constexpr (operation == order_of_first_words) {
            const auto order = certain_order(cursor.word(0), cursor.word(1), cursor.word(2));
            cursor.store(3, order.less.yes());
            cursor.store(4, order.less.no());
            cursor.store(5, order.at_most.yes());
            cursor.store(6, order.at_most.no());
        } else if constexpr (operation == first_root_of_quartic) {
            const QuarticChain<P> chain(cursor.word(0), cursor.word(1), cursor.word(2), cursor.word(3));
            cursor.store(6, approximate_first_root(chain, cursor.word(4), cursor.word(5), newton_steps));
        }
    }
};

/// The bounded numbers of an instruction. If bit k of `exact_mask` is set, number k is exact: it has one word and no
/// bound. `exact_mask` is a template argument, so the compiler drops the operations on words and bounds that do not
/// exist.
template <class Number, unsigned exact_mask, std::size_t count>
struct BoundedOperands {
    using Bounded = RunningError<Number>;
    using P = typename Bounded::P;
    static constexpr bool has_two_words = !std::is_same_v<Number, P>;

    static constexpr std::size_t index_of(std::size_t operand) {
        std::size_t index = 0;
        for (std::size_t k = 0; k < operand; ++k) index += (exact_mask >> k & 1) != 0 ? 1 : has_two_words ? 3 : 2;
        return index;
    }
    /// Number of columns, for operands and results.
    static constexpr std::size_t column_count(bool is_decision) {
        return index_of(count) + (is_decision || !has_two_words ? 2 : 3);
    }
    template <std::size_t k, class Cursor>
    [[gnu::always_inline]] static Bounded load(const Cursor& cursor) {
        constexpr std::size_t index = index_of(k);
        if constexpr ((exact_mask >> k & 1) != 0) return Bounded(Number(cursor.word(index)), P(0));
        else if constexpr (has_two_words)
            return Bounded(Number(cursor.word(index), cursor.word(index + 1)), cursor.word(index + 2));
        else return Bounded(cursor.word(index), cursor.word(index + 1));
    }
    template <class Cursor>
    [[gnu::always_inline]] static void store(const Cursor& cursor, const Bounded& x) {
        constexpr std::size_t index = index_of(count);
        cursor.store(index, x.first());
        if constexpr (has_two_words) cursor.store(index + 1, x.second());
        cursor.store(index + (has_two_words ? 2 : 1), x.bound());
    }
    template <class Cursor>
    [[gnu::always_inline]] static void store(const Cursor& cursor, const TriMask<mask_t<P>>& x) {
        cursor.store(index_of(count), x.yes());
        cursor.store(index_of(count) + 1, x.no());
    }
};

template <ColumnOperation operation, class Bounded, class... Others>
[[gnu::always_inline]] inline auto compute(const Bounded& a, const Others&... others) {
    using enum ColumnOperation;
    if constexpr (operation == bounded_square) return square(a, others...);
    else if constexpr (operation == bounded_root) return sqrt(a, others...);
    else if constexpr (operation == bounded_add) return (a + ... + others);
    else if constexpr (operation == bounded_subtract) return (a - ... - others);
    else if constexpr (operation == bounded_multiply) return (a * ... * others);
    else if constexpr (operation == bounded_divide) return (a / ... / others);
    else if constexpr (operation == bounded_less) return (a < ... < others);
    else if constexpr (operation == bounded_at_most) return (a <= ... <= others);
    else if constexpr (operation == ColumnOperation::bounded_product_difference)
        return difference_of_products(a, others...);
    else if constexpr (operation == ColumnOperation::bounded_product_sum) return sum_of_products(a, others...);
    else if constexpr (operation == ColumnOperation::bounded_square_sum) return sum_of_squares(a, others...);
}

template <ColumnOperation operation, unsigned exact_mask, class Number>
struct BoundedStep {
    static constexpr std::size_t count = bounded_operand_count(operation);
    static constexpr bool is_decision =
        operation == ColumnOperation::bounded_less || operation == ColumnOperation::bounded_at_most;
    using Operands = BoundedOperands<Number, exact_mask, count>;
    static constexpr std::size_t column_count = Operands::column_count(is_decision);

    template <class Cursor>
    [[gnu::always_inline]] static void apply(const Cursor& cursor) {
        apply_to_operands(cursor, std::make_index_sequence<count>());
    }

private:
    template <class Cursor, std::size_t... k>
    [[gnu::always_inline]] static void apply_to_operands(const Cursor& cursor, std::index_sequence<k...>) {
        Operands::store(cursor, compute<operation>(Operands::template load<k>(cursor)...));
    }
};

template <class Number, ColumnOperation operation>
void fill_kernels(ColumnKernels::OperationKernels& kernels) {
    using P = typename RunningError<Number>::P;
    constexpr std::size_t operands = bounded_operand_count(operation);
    if constexpr (operands == 0) {
        kernels.fill(run_step<P, WordStep<operation, P>>);
    } else {
        [&]<std::size_t... masks>(std::index_sequence<masks...>) {
            const auto fill = [&]<std::size_t mask>() {
                if constexpr (exact_operands_with_kernel(mask, operands) == mask)
                    kernels[mask] = run_step<P, BoundedStep<operation, mask, Number>>;
            };
            (fill.template operator()<masks>(), ...);
        }
        (std::make_index_sequence<std::size_t{1} << operands>());
    }
}
template <class Number>
void fill_kernels(ColumnKernels::WordKernels& kernels) {
    [&]<std::size_t... k>(std::index_sequence<k...>) {
        (fill_kernels<Number, static_cast<ColumnOperation>(k)>(kernels[k]), ...);
    }
    (std::make_index_sequence<number::wide::column_operation_count - 1>());  // a gate has no kernel
}

template <class P>
struct ColumnMoves {
    template <class S>
    static void load(const RawColumn<S>& source, std::size_t first, double* target, std::size_t pack_count) {
        for (std::size_t i = 0; i < pack_count; ++i)
            P::load(source.from + (first + i * P::lanes) * source.step).store(target + i * P::lanes);
    }
    static void repeat(double x, double* target) { P(x).store(target); }
    static bool is_any(const double* mask, std::size_t pack_count) {
        mask_t<P> any = mask_of(P::load(mask));
        for (std::size_t i = 1; i < pack_count; ++i) any = any || mask_of(P::load(mask + i * P::lanes));
        return any_of(any);
    }
    static void store_mask(const ColumnCells& mask, std::uint8_t* target, std::size_t pack_count) {
        for (std::size_t i = 0; i < pack_count; ++i) {
            bool lanes[P::lanes];
            mask_of(pack_at(mask, i)).store(lanes);
            std::memcpy(target + i * P::lanes, lanes, P::lanes);
        }
    }
    static void store_where(const ColumnCells& mask, const ColumnCells& x, double* target, std::size_t pack_count) {
        for (std::size_t i = 0; i < pack_count; ++i)
            select(mask_of(pack_at(mask, i)), pack_at(x, i), P(0)).store(target + i * P::lanes);
    }

private:
    static P pack_at(const ColumnCells& column, std::size_t pack) { return P::load(column.from + pack * column.step); }
};

template <class P>
ColumnKernels make_column_kernels() {
    ColumnKernels kernels{.lanes = P::lanes,
                          .load_floats = ColumnMoves<P>::template load<float>,
                          .load_doubles = ColumnMoves<P>::template load<double>,
                          .repeat = ColumnMoves<P>::repeat,
                          .is_any = ColumnMoves<P>::is_any,
                          .store_mask = ColumnMoves<P>::store_mask,
                          .store_where = ColumnMoves<P>::store_where};
    fill_kernels<P>(kernels.by_words[0]);
    fill_kernels<TwoWords<P>>(kernels.by_words[1]);
    return kernels;
}

}  // namespace lostbits::measure::stages
