// `RunningError` over recorded words. A formula instantiated once with these numbers becomes a program of columns.
#pragma once

#include <concepts>

#include "number/wide/column_program.hpp"
#include "number/wide/running_error.hpp"

namespace lostbits::number::wide {

/// Records an instruction on words or masks, and returns its only result.
template <class... Columns>
ColumnIndex record_instruction(ColumnOperation operation, Columns... columns) {
    ColumnInstruction instruction{
        .operation = operation, .input_count = sizeof...(columns), .output_count = 1, .in = {columns...}};
    return ColumnRecorder::current().record(instruction)[0];
}

/// A decision for every ray of a column.
class ColumnMask : public NotABool {
public:
    ColumnMask() = default;
    explicit ColumnMask(ColumnIndex index) : index_(index) {}

    [[nodiscard]] ColumnIndex index() const { return index_; }

    friend ColumnMask operator&&(const ColumnMask& a, const ColumnMask& b) {
        return ColumnMask(record_instruction(ColumnOperation::mask_and, a.index_, b.index_));
    }
    friend ColumnMask operator||(const ColumnMask& a, const ColumnMask& b) {
        return ColumnMask(record_instruction(ColumnOperation::mask_or, a.index_, b.index_));
    }
    friend ColumnMask operator!(const ColumnMask& a) {
        return ColumnMask(record_instruction(ColumnOperation::mask_not, a.index_));
    }
    /// True in every case: a program contains every branch.
    friend bool any_of(const ColumnMask&) { return true; }
    /// Begins a part of the program that is needed only if the mask is set in some lane.
    friend bool is_unset(const ColumnMask& a) {
        ColumnRecorder::current().record({.operation = ColumnOperation::gate, .input_count = 1, .in = {a.index_}});
        return false;
    }

private:
    ColumnIndex index_ = 0;
};

/// A double for every ray of a column.
class ColumnWord {
public:
    ColumnWord() = default;
    explicit ColumnWord(std::integral auto x) : ColumnWord(static_cast<double>(x)) {}
    explicit ColumnWord(std::floating_point auto x)
        : index_(ColumnRecorder::current().constant(static_cast<double>(x))), is_zero_(!(x < 0) && !(x > 0)) {}

    static ColumnWord at(ColumnIndex index) {
        ColumnWord x;
        x.index_ = index;
        return x;
    }
    [[nodiscard]] ColumnIndex index() const { return index_; }
    /// True if x is known while recording to be 0, whatever the inputs.
    friend bool is_known_zero(const ColumnWord& x) { return x.is_zero_; }

    friend ColumnWord operator+(const ColumnWord& a, const ColumnWord& b) {
        return record_word(ColumnOperation::add, a, b);
    }
    friend ColumnWord operator-(const ColumnWord& a, const ColumnWord& b) {
        return record_word(ColumnOperation::subtract, a, b);
    }
    friend ColumnWord operator*(const ColumnWord& a, const ColumnWord& b) {
        return record_word(ColumnOperation::multiply, a, b);
    }
    friend ColumnWord operator/(const ColumnWord& a, const ColumnWord& b) {
        return record_word(ColumnOperation::divide, a, b);
    }
    friend ColumnWord operator-(const ColumnWord& a) {
        if (a.index_ < 0) return ColumnWord(-ColumnRecorder::current().constant_at(a.index_));
        return record_word(ColumnOperation::negate, a);
    }
    friend ColumnWord abs(const ColumnWord& a) { return record_word(ColumnOperation::absolute, a); }
    friend ColumnWord max(const ColumnWord& a, const ColumnWord& b) {
        return record_word(ColumnOperation::maximum, a, b);
    }
    friend ColumnWord binade(const ColumnWord& a) { return record_word(ColumnOperation::power_at_most, a); }
    friend ColumnWord select(const ColumnMask& mask, const ColumnWord& a, const ColumnWord& b) {
        if (a.index_ == b.index_) return a;
        return at(record_instruction(ColumnOperation::choose, mask.index(), a.index_, b.index_));
    }
    friend ColumnMask operator<(const ColumnWord& a, const ColumnWord& b) {
        return ColumnMask(record_instruction(ColumnOperation::less, a.index_, b.index_));
    }
    friend ColumnMask operator<=(const ColumnWord& a, const ColumnWord& b) {
        return ColumnMask(record_instruction(ColumnOperation::at_most, a.index_, b.index_));
    }
    friend ColumnMask operator>(const ColumnWord& a, const ColumnWord& b) { return b < a; }
    friend ColumnMask operator>=(const ColumnWord& a, const ColumnWord& b) { return b <= a; }

private:
    template <class... Words>
    static ColumnWord record_word(ColumnOperation operation, const Words&... words) {
        return at(record_instruction(operation, words.index_...));
    }

    ColumnIndex index_ = 0;
    bool is_zero_ = false;
};

/// Records the operation of three words and four masks described at `stages::certain_order`.
inline Order<TriMask<ColumnMask>> order_of_first_words(const ColumnWord& x, const ColumnWord& y,
                                                       const ColumnWord& least) {
    const auto results = ColumnRecorder::current().record({.operation = ColumnOperation::order_of_first_words,
                                                           .input_count = 3,
                                                           .output_count = 4,
                                                           .in = {x.index(), y.index(), least.index()}});
    const auto mask = [&results](std::size_t k) { return ColumnMask(results[k]); };
    return {{mask(0), mask(1)}, {mask(2), mask(3)}};
}

template <class W>
concept ColumnWords = std::same_as<W, ColumnWord> || std::same_as<W, TwoWords<ColumnWord>>;

/// The same number over recorded words. Each operation is one instruction, whose kernel is that of `RunningError` over
/// packs, so its words and bounds have the same bits. If a number has no second word and no bound when it is recorded,
/// it has none for any ray.
template <ColumnWords W>
class RunningError<W> {
public:
    using P = ColumnWord;
    using Lanes = ColumnMask;

    RunningError() = default;
    explicit RunningError(std::same_as<int> auto x) : w_(x), e_(0) {}
    explicit RunningError(const W& w) : w_(w), e_(0) {}
    RunningError(const W& w, const P& e) : w_(w), e_(e) {}

    [[nodiscard]] const W& words() const { return w_; }
    [[nodiscard]] const P& first() const { return WordProperties<W>::first(w_); }
    [[nodiscard]] P second() const { return WordProperties<W>::second(w_); }
    [[nodiscard]] const P& bound() const { return e_; }
    [[nodiscard]] P radius() const { return e_ * P(1 + 0x1p-40); }

    friend RunningError operator+(const RunningError& a, const RunningError& b) {
        return record_number(ColumnOperation::bounded_add, a, b);
    }
    friend RunningError operator-(const RunningError& a, const RunningError& b) {
        return record_number(ColumnOperation::bounded_subtract, a, b);
    }
    friend RunningError operator-(const RunningError& a) { return {WordProperties<W>::negative(a.w_), a.e_}; }
    friend RunningError operator*(const RunningError& a, const RunningError& b) {
        return record_number(ColumnOperation::bounded_multiply, a, b);
    }
    friend RunningError operator/(const RunningError& a, const RunningError& b) {
        return record_number(ColumnOperation::bounded_divide, a, b);
    }
    friend RunningError square(const RunningError& a) { return record_number(ColumnOperation::bounded_square, a); }
    friend RunningError sqrt(const RunningError& a) { return record_number(ColumnOperation::bounded_root, a); }
    friend RunningError difference_of_products(const RunningError& a, const RunningError& b, const RunningError& c,
                                               const RunningError& d) {
        return record_number(ColumnOperation::bounded_product_difference, a, b, c, d);
    }
    friend RunningError sum_of_products(const RunningError& a, const RunningError& b, const RunningError& c,
                                        const RunningError& d, const RunningError& f, const RunningError& g) {
        return record_number(ColumnOperation::bounded_product_sum, a, b, c, d, f, g);
    }
    friend RunningError sum_of_squares(const RunningError& a, const RunningError& b, const RunningError& c) {
        return record_number(ColumnOperation::bounded_square_sum, a, b, c);
    }
    RunningError& operator+=(const RunningError& b) { return *this = *this + b; }
    RunningError& operator-=(const RunningError& b) { return *this = *this - b; }
    RunningError& operator*=(const RunningError& b) { return *this = *this * b; }

    friend TriMask<Lanes> operator<(const RunningError& a, const RunningError& b) {
        return record_decision(ColumnOperation::bounded_less, a, b);
    }
    friend TriMask<Lanes> operator<=(const RunningError& a, const RunningError& b) {
        return record_decision(ColumnOperation::bounded_at_most, a, b);
    }
    friend TriMask<Lanes> operator>(const RunningError& a, const RunningError& b) { return !(a <= b); }
    friend TriMask<Lanes> operator>=(const RunningError& a, const RunningError& b) { return !(a < b); }

    friend RunningError fma(const RunningError& a, const RunningError& b, const RunningError& c) { return a * b + c; }
    friend RunningError next_up(const RunningError& a) { return a; }
    friend RunningError next_down(const RunningError& a) { return a; }
    friend RunningError abs(const RunningError& a) {
        const Lanes is_negative = a.first() < P(0);
        return {select(is_negative, WordProperties<W>::negative(a.w_), a.w_), a.e_};
    }
    friend RunningError copysign(const RunningError& a, const RunningError& b) {
        const RunningError x = abs(a), zero(0);
        return select(TriMask<Lanes>((b < zero).yes(), (b > zero).yes()), -x, x);
    }
    friend RunningError select(const Lanes& mask, const RunningError& a, const RunningError& b) {
        return {select(mask, a.w_, b.w_), select(mask, a.e_, b.e_)};
    }
    friend RunningError select(const TriMask<Lanes>& mask, const RunningError& a, const RunningError& b) {
        const RunningError x = select(mask.yes(), a, b);
        return {x.w_, select(mask.yes() || mask.no(), x.e_, P(HUGE_VAL))};
    }

private:
    static constexpr bool has_two_words = !std::same_as<W, ColumnWord>;

    [[nodiscard]] bool is_exact_word() const {
        if (!is_known_zero(e_)) return false;
        if constexpr (has_two_words) return is_known_zero(w_.lo);
        else return true;
    }
    template <class... Numbers>
    static auto record_operation(ColumnOperation operation, std::uint8_t output_count, const Numbers&... numbers) {
        const std::array<const RunningError*, sizeof...(numbers)> operands{&numbers...};
        unsigned exact = 0;
        for (std::size_t k = 0; k < operands.size(); ++k)
            exact |= static_cast<unsigned>(operands[k]->is_exact_word()) << k;
        ColumnInstruction instruction{
            .operation = operation,
            .exact = static_cast<std::uint8_t>(exact_operands_with_kernel(exact, operands.size())),
            .output_count = output_count};
        for (std::size_t k = 0; k < operands.size(); ++k) {
            instruction.in[instruction.input_count++] = operands[k]->first().index();
            if ((instruction.exact >> k & 1) != 0) continue;
            if constexpr (has_two_words) instruction.in[instruction.input_count++] = operands[k]->w_.lo.index();
            instruction.in[instruction.input_count++] = operands[k]->e_.index();
        }
        return ColumnRecorder::current().record(instruction);
    }
    template <class... Numbers>
    static RunningError record_number(ColumnOperation operation, const Numbers&... numbers) {
        const auto results = record_operation(operation, has_two_words ? 3 : 2, numbers...);
        if constexpr (has_two_words) return {W(P::at(results[0]), P::at(results[1])), P::at(results[2])};
        else return {P::at(results[0]), P::at(results[1])};
    }
    static TriMask<Lanes> record_decision(ColumnOperation operation, const RunningError& a, const RunningError& b) {
        const auto results = record_operation(operation, 2, a, b);
        return {Lanes(results[0]), Lanes(results[1])};
    }

    W w_;
    P e_;
};

static_assert(Number<RunningError<ColumnWord>> && Number<RunningError<TwoWords<ColumnWord>>>);

}  // namespace lostbits::number::wide
