// `Running` over recorded words: a formula is instantiated once with these numbers to become a program of columns.
#pragma once

#include <concepts>

#include "number/wide/column_program.hpp"
#include "number/wide/running.hpp"

namespace lostbits::number::wide {

/// An instruction of words or of masks, with one result.
template <class... Places>
ColumnIndex recorded(ColumnOperation operation, Places... places) {
    ColumnInstruction step{.operation = operation, .ins = sizeof...(places), .outs = 1, .in = {places...}};
    return ColumnRecorder::current().record(step)[0];
}

/// A decision about every ray of a column.
class ColumnMask : public NotABool {
public:
    ColumnMask() = default;
    explicit ColumnMask(ColumnIndex place) : place_(place) {}

    [[nodiscard]] ColumnIndex place() const { return place_; }

    friend ColumnMask operator&&(const ColumnMask& a, const ColumnMask& b) {
        return ColumnMask(recorded(ColumnOperation::both, a.place_, b.place_));
    }
    friend ColumnMask operator||(const ColumnMask& a, const ColumnMask& b) {
        return ColumnMask(recorded(ColumnOperation::either, a.place_, b.place_));
    }
    friend ColumnMask operator!(const ColumnMask& a) {
        return ColumnMask(recorded(ColumnOperation::opposite, a.place_));
    }
    /// Always true: a program takes every branch.
    friend bool any_of(const ColumnMask&) { return true; }
    /// Begins a part of the program that is needed only if the mask is set in some lane.
    friend bool is_unset(const ColumnMask& a) {
        ColumnRecorder::current().record({.operation = ColumnOperation::gate, .ins = 1, .in = {a.place_}});
        return false;
    }

private:
    ColumnIndex place_ = 0;
};

/// A double of every ray of a column.
class ColumnWord {
public:
    ColumnWord() = default;
    explicit ColumnWord(std::integral auto x) : ColumnWord(static_cast<double>(x)) {}
    explicit ColumnWord(std::floating_point auto x)
        : place_(ColumnRecorder::current().constant(static_cast<double>(x))), is_zero_(!(x < 0) && !(x > 0)) {}

    static ColumnWord at(ColumnIndex place) {
        ColumnWord x;
        x.place_ = place;
        return x;
    }
    [[nodiscard]] ColumnIndex place() const { return place_; }
    /// True if x is known to be 0 from the recording, whatever the inputs.
    friend bool is_known_zero(const ColumnWord& x) { return x.is_zero_; }

    friend ColumnWord operator+(const ColumnWord& a, const ColumnWord& b) { return of(ColumnOperation::add, a, b); }
    friend ColumnWord operator-(const ColumnWord& a, const ColumnWord& b) {
        return of(ColumnOperation::subtract, a, b);
    }
    friend ColumnWord operator*(const ColumnWord& a, const ColumnWord& b) {
        return of(ColumnOperation::multiply, a, b);
    }
    friend ColumnWord operator/(const ColumnWord& a, const ColumnWord& b) { return of(ColumnOperation::divide, a, b); }
    friend ColumnWord operator-(const ColumnWord& a) {
        if (a.place_ < 0) return ColumnWord(-ColumnRecorder::current().constant_at(a.place_));
        return of(ColumnOperation::negate, a);
    }
    friend ColumnWord abs(const ColumnWord& a) { return of(ColumnOperation::absolute, a); }
    friend ColumnWord max(const ColumnWord& a, const ColumnWord& b) { return of(ColumnOperation::largest, a, b); }
    friend ColumnWord binade(const ColumnWord& a) { return of(ColumnOperation::power_below, a); }
    friend ColumnWord select(const ColumnMask& mask, const ColumnWord& a, const ColumnWord& b) {
        if (a.place_ == b.place_) return a;
        return at(recorded(ColumnOperation::choose, mask.place(), a.place_, b.place_));
    }
    friend ColumnMask operator<(const ColumnWord& a, const ColumnWord& b) {
        return ColumnMask(recorded(ColumnOperation::less, a.place_, b.place_));
    }
    friend ColumnMask operator<=(const ColumnWord& a, const ColumnWord& b) {
        return ColumnMask(recorded(ColumnOperation::at_most, a.place_, b.place_));
    }
    friend ColumnMask operator>(const ColumnWord& a, const ColumnWord& b) { return b < a; }
    friend ColumnMask operator>=(const ColumnWord& a, const ColumnWord& b) { return b <= a; }

private:
    template <class... Words>
    static ColumnWord of(ColumnOperation operation, const Words&... words) {
        return at(recorded(operation, words.place_...));
    }

    ColumnIndex place_ = 0;
    bool is_zero_ = false;
};

/// The operation of three words and four masks: see `stages::certain_order`.
inline Order<Tris<ColumnMask>> order_of_first_words(const ColumnWord& x, const ColumnWord& y, const ColumnWord& least) {
    const auto out = ColumnRecorder::current().record({.operation = ColumnOperation::order_of_first_words,
                                                       .ins = 3,
                                                       .outs = 4,
                                                       .in = {x.place(), y.place(), least.place()}});
    const auto mask = [&out](std::size_t k) { return ColumnMask(out[k]); };
    return {{mask(0), mask(1)}, {mask(2), mask(3)}};
}

template <class W>
concept ColumnWords = std::same_as<W, ColumnWord> || std::same_as<W, TwoWords<ColumnWord>>;

/// Running numbers over recorded words. Each operation is one instruction, whose kernel is that of `Running` over
/// packs, so its words and bounds have the same bits. If a number is known to have no second word and no bound when it
/// is recorded, that holds for every ray.
template <ColumnWords W>
class Running<W> {
public:
    using P = ColumnWord;
    using Lanes = ColumnMask;

    Running() = default;
    explicit Running(std::same_as<int> auto x) : w_(x), e_(0) {}
    explicit Running(const W& w) : w_(w), e_(0) {}
    Running(const W& w, const P& e) : w_(w), e_(e) {}

    [[nodiscard]] const W& words() const { return w_; }
    [[nodiscard]] const P& first() const { return Words<W>::first(w_); }
    [[nodiscard]] P second() const { return Words<W>::second(w_); }
    [[nodiscard]] const P& bound() const { return e_; }
    [[nodiscard]] P radius() const { return e_ * P(1 + 0x1p-40); }

    friend Running operator+(const Running& a, const Running& b) { return number(ColumnOperation::sum, a, b); }
    friend Running operator-(const Running& a, const Running& b) { return number(ColumnOperation::difference, a, b); }
    friend Running operator-(const Running& a) { return {Words<W>::negative(a.w_), a.e_}; }
    friend Running operator*(const Running& a, const Running& b) { return number(ColumnOperation::product, a, b); }
    friend Running operator/(const Running& a, const Running& b) { return number(ColumnOperation::quotient, a, b); }
    friend Running square(const Running& a) { return number(ColumnOperation::squared, a); }
    friend Running sqrt(const Running& a) { return number(ColumnOperation::root, a); }
    friend Running difference_of_products(const Running& a, const Running& b, const Running& c, const Running& d) {
        return number(ColumnOperation::product_difference, a, b, c, d);
    }
    friend Running sum_of_products(const Running& a, const Running& b, const Running& c, const Running& d,
                                   const Running& f, const Running& g) {
        return number(ColumnOperation::product_sum, a, b, c, d, f, g);
    }
    friend Running sum_of_squares(const Running& a, const Running& b, const Running& c) {
        return number(ColumnOperation::square_sum, a, b, c);
    }
    Running& operator+=(const Running& b) { return *this = *this + b; }
    Running& operator-=(const Running& b) { return *this = *this - b; }
    Running& operator*=(const Running& b) { return *this = *this * b; }

    friend Tris<Lanes> operator<(const Running& a, const Running& b) { return told(ColumnOperation::is_less, a, b); }
    friend Tris<Lanes> operator<=(const Running& a, const Running& b) {
        return told(ColumnOperation::is_at_most, a, b);
    }
    friend Tris<Lanes> operator>(const Running& a, const Running& b) { return !(a <= b); }
    friend Tris<Lanes> operator>=(const Running& a, const Running& b) { return !(a < b); }

    friend Running fma(const Running& a, const Running& b, const Running& c) { return a * b + c; }
    friend Running next_up(const Running& a) { return a; }
    friend Running next_down(const Running& a) { return a; }
    friend Running abs(const Running& a) {
        const Lanes below = a.first() < P(0);
        return {select(below, Words<W>::negative(a.w_), a.w_), a.e_};
    }
    friend Running copysign(const Running& a, const Running& b) {
        const Running x = abs(a), zero(0);
        return select(Tris<Lanes>((b < zero).yes(), (b > zero).yes()), -x, x);
    }
    friend Running select(const Lanes& mask, const Running& a, const Running& b) {
        return {select(mask, a.w_, b.w_), select(mask, a.e_, b.e_)};
    }
    friend Running select(const Tris<Lanes>& mask, const Running& a, const Running& b) {
        const Running x = select(mask.yes(), a, b);
        return {x.w_, select(mask.yes() || mask.no(), x.e_, P(HUGE_VAL))};
    }

private:
    static constexpr bool has_two = !std::same_as<W, ColumnWord>;

    [[nodiscard]] bool is_one_word() const {
        if (!is_known_zero(e_)) return false;
        if constexpr (has_two) return is_known_zero(w_.lo);
        else return true;
    }
    template <class... Numbers>
    static auto step(ColumnOperation operation, std::uint8_t outs, const Numbers&... numbers) {
        const std::array<const Running*, sizeof...(numbers)> all{&numbers...};
        unsigned exact = 0;
        for (std::size_t k = 0; k < all.size(); ++k) exact |= static_cast<unsigned>(all[k]->is_one_word()) << k;
        ColumnInstruction one{
            .operation = operation, .exact = static_cast<std::uint8_t>(known_exact(exact, all.size())), .outs = outs};
        for (std::size_t k = 0; k < all.size(); ++k) {
            one.in[one.ins++] = all[k]->first().place();
            if ((one.exact >> k & 1) != 0) continue;
            if constexpr (has_two) one.in[one.ins++] = all[k]->w_.lo.place();
            one.in[one.ins++] = all[k]->e_.place();
        }
        return ColumnRecorder::current().record(one);
    }
    template <class... Numbers>
    static Running number(ColumnOperation operation, const Numbers&... numbers) {
        const auto out = step(operation, has_two ? 3 : 2, numbers...);
        if constexpr (has_two) return {W(P::at(out[0]), P::at(out[1])), P::at(out[2])};
        else return {P::at(out[0]), P::at(out[1])};
    }
    static Tris<Lanes> told(ColumnOperation operation, const Running& a, const Running& b) {
        const auto out = step(operation, 2, a, b);
        return {Lanes(out[0]), Lanes(out[1])};
    }

    W w_;
    P e_;
};

static_assert(Number<Running<ColumnWord>> && Number<Running<TwoWords<ColumnWord>>>);

}  // namespace lostbits::number::wide
