// Operations that contribute the same: the culprit among them depends on the formula, and not on the order of its tape.
#include "measure/attribution/attribution.hpp"

#include <algorithm>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "number/recorded.hpp"
#include "number/recorders/tape_recorder.hpp"

namespace lostbits::test::test_ties {

using intersect::table::Intersector;
using measure::attribution::Attribution;

namespace {

struct ShuffledOrder {
    Tape tape;
    std::vector<NodeId> place;  ///< of each node of the tape as it was

    [[nodiscard]] NodeId at(NodeId i) const { return i == no_node ? no_node : place[i]; }
    [[nodiscard]] std::vector<NodeId> at(std::vector<NodeId> nodes) const {
        for (NodeId& i : nodes) i = at(i);
        return nodes;
    }
};

/// The same operations in a random order in which each comes after its operands.
ShuffledOrder shuffle(const Tape& tape, Random& random) {
    ShuffledOrder s{tape, std::vector<NodeId>(tape.nodes.size(), no_node)};
    std::vector<std::vector<NodeId>> users(tape.nodes.size());
    std::vector<int> waits(tape.nodes.size());
    std::vector<NodeId> ready;
    for (NodeId i = 0; i < tape.size(); ++i) {
        for (const NodeId operand : tape.operands_of(i)) {
            if (operand == no_node) continue;
            users[operand].push_back(i);
            ++waits[i];
        }
        if (waits[i] == 0) ready.push_back(i);
    }
    NodeId next = 0;
    while (!ready.empty()) {
        const auto k = static_cast<std::size_t>(random.unit() * static_cast<double>(ready.size()));
        const NodeId i = ready[k];
        ready.erase(ready.begin() + static_cast<std::ptrdiff_t>(k));
        s.place[i] = next;
        TapeNode& n = s.tape[next++] = tape[i];
        if (!is_given(n.op)) {
            for (NodeId& operand : n.operands) operand = s.at(operand);
        }
        for (const NodeId user : users[i]) {
            if (--waits[user] == 0) ready.push_back(user);
        }
    }
    for (TapeCall& call : s.tape.calls) call.node = s.at(call.node), call.arguments = s.at(call.arguments);
    s.tape.sample_ends.clear();
    s.tape.outputs = {s.at(tape.outputs.hit), s.at(tape.outputs.t), s.at(tape.outputs.near), s.at(tape.outputs.far)};
    return s;
}

/// Counts of ties over many tapes.
struct SeenTies {
    int ties = 0;       ///< tapes with equals
    int not_first = 0;  ///< of which the culprit is not the first on the tape
};

/// The tape has the same culprit and the same equal contributions in every order.
void demand_one_culprit(const Tape& tape, bool is_solver, Random& random, SeenTies& seen) {
    const Attribution a = measure::attribution::attribute(tape);
    for (int k = 0; k < 3; ++k) {
        const ShuffledOrder s = shuffle(tape, random);
        const Attribution b = measure::attribution::attribute(s.tape);
        REQUIRE(b.subject == s.at(a.subject));
        REQUIRE(b.culprit == s.at(a.culprit));
        // Adjoints over the thousands of operations of a solver are long sums, which differ in the last place in
        // another order.
        if (!is_solver) REQUIRE(b.equal_culprits == s.at(a.equal_culprits));
    }
    seen.ties += !a.equal_culprits.empty();
    seen.not_first += std::ranges::any_of(a.equal_culprits, [&](NodeId i) { return i < a.culprit; });
}

/// A tape by hand, in binary64. Sums at 2^53, whose ulp is 2: 2^53 + 1 rounds down and (2^53 + 2) + 1 up, both by 1.
struct HandTape {
    using T = Recorded;
    Tape tape;
    number::recorders::TapeRecorder recorder{tape, binary64};
    T down() const { return T(0x1p53) + T(1.0); }
    T up() const { return T(0x1p53 + 2) + T(1.0); }
};

/// In every order of the tape.
Attribution attribution_of(const HandTape& hand, const Recorded& t) {
    Random random(3);
    const Attribution a = measure::attribution::attribute(hand.tape, t.node());
    for (int k = 0; k < 50; ++k) {
        const ShuffledOrder s = shuffle(hand.tape, random);
        const Attribution b = measure::attribution::attribute(s.tape, s.at(t.node()));
        CHECK(b.culprit == s.at(a.culprit));
        CHECK(b.equal_culprits == s.at(a.equal_culprits));
    }
    return a;
}

}  // namespace

TEST_CASE("ties: of two roundings that cancel, the later one on the chain is the culprit", "[ties]") {
    const HandTape hand;
    const auto sum = hand.down();        // −1
    const auto c = sum + Recorded(3.0);  // 2^53 + 3, up by 1
    const Attribution a = attribution_of(hand, c);
    CHECK(a[sum.node()].contribution == -1);
    CHECK(a[c.node()].contribution == 1);
    CHECK(a.error == 0);
    CHECK(a.culprit == c.node());
    CHECK(a.equal_culprits == std::vector{sum.node()});
    CHECK(is_computed_from(hand.tape, a, c.node(), sum.node()));
    CHECK_FALSE(is_computed_from(hand.tape, a, sum.node(), c.node()));
}

TEST_CASE("ties: of two roundings that add up, the later one on the chain is the culprit", "[ties]") {
    const HandTape hand;
    const auto sum = hand.up();          // +1
    const auto c = sum - Recorded(1.0);  // (2^53 + 4) − 1, up by 1
    const Attribution a = attribution_of(hand, c);
    CHECK(a.error == 2);
    CHECK(a.culprit == c.node());
    CHECK(a.equal_culprits == std::vector{sum.node()});
}

TEST_CASE("ties: of two roundings on separate chains, the nearer to the result is the culprit, then the first",
          "[ties]") {
    for (const bool down_first : {true, false}) {
        const HandTape hand;
        const auto down = hand.down(), up = hand.up();
        const auto t = down_first ? down + up : up + down;
        const Attribution a = attribution_of(hand, t);
        CHECK(a.culprit == (down_first ? down : up).node());
        CHECK(a.equal_culprits == std::vector{(down_first ? up : down).node()});
        CHECK_FALSE(is_computed_from(hand.tape, a, up.node(), down.node()));
    }
    const HandTape hand;
    const auto down = hand.down(), up = hand.up();
    const auto t = -down + up;
    CHECK(attribution_of(hand, t).culprit == up.node());
}

TEST_CASE("ties: three equal roundings are resolved by the same rules", "[ties]") {
    for (const bool chain_first : {true, false}) {
        const HandTape hand;
        const auto sum = hand.down(), c = sum + Recorded(3.0), up = hand.up();
        const auto t = chain_first ? c + up : up + c;
        const Attribution a = attribution_of(hand, t);
        CHECK(a.culprit == (chain_first ? c : up).node());
        CHECK(a.equal_culprits == std::vector{(chain_first ? up : c).node(), sum.node()});
    }
}

TEST_CASE("ties: a branch that is not taken does not make a chain", "[ties]") {
    const HandTape hand;
    const auto down = hand.down(), other = hand.down();
    const auto taken = select(Recorded(1.0) < Recorded(2.0), other, down);
    const auto c = taken + Recorded(3.0);
    const auto t = down + c;
    const Attribution a = attribution_of(hand, t);
    CHECK(a.culprit == down.node());
    CHECK(a.equal_culprits == std::vector{c.node(), other.node()});
    CHECK_FALSE(is_computed_from(hand.tape, a, c.node(), down.node()));
    CHECK(is_computed_from(hand.tape, a, c.node(), other.node()));
}

TEST_CASE("ties: wrong choices that undo each other are the culprit only where nothing else was lost", "[ties]") {
    using T = HandTape::T;
    const auto chosen = [](const HandTape& hand) { return select(hand.down() > T(0x1p53), T(1000), T(2000)); };
    HandTape hand;
    const T a = chosen(hand), b = chosen(hand), third = T(1) / T(3);
    const Attribution with = attribution_of(hand, (a - b) + third);
    CHECK(with.culprit == third.node());
    CHECK(with.equal_culprits.empty());
    const Attribution alone = attribution_of(hand, a - b);
    CHECK((alone.culprit == a.node() || alone.culprit == b.node()));
    CHECK(alone.equal_culprits.size() == 1);
    const Attribution one = attribution_of(hand, a + third);
    CHECK(one.culprit == a.node());
}

TEST_CASE("ties: a choice between two numbers that have the same computed value makes no error", "[ties]") {
    using T = HandTape::T;
    for (const bool sum_first : {true, false}) {
        const HandTape hand;
        const auto sum = hand.down(), number = T(0x1p53);  // 2^53 + 1 without rounding, and 2^53: the larger is the sum
        const auto t = sum_first ? max(sum, number) : max(number, sum);
        const Attribution a = attribution_of(hand, t);
        CHECK(a.culprit == sum.node());
        CHECK(a.equal_culprits.empty());
        CHECK(a.error == -1);
        CHECK_FALSE(a[t.node()].decision_changed);
        CHECK(a[t.node()].chosen_side == sum.node());
    }
}

TEST_CASE("ties: contributions are equal if they agree to 2^-20", "[ties]") {
    for (const auto& [more, equal] : {std::pair{0x1p-21, true}, std::pair{0x1p-19, false}}) {
        const HandTape hand;
        const auto larger = hand.down(), smaller = hand.up();
        const auto t = larger * Recorded(1 + more) + smaller;
        const Attribution a = attribution_of(hand, t);
        CHECK(a.culprit == (equal ? smaller : larger).node());
        CHECK(a.equal_culprits.empty() != equal);
        CHECK(measure::attribution::find_largest_contributions(hand.tape, a, 1).empty());
    }
}

TEST_CASE("ties: roundings that do not reach the answer take no part", "[ties]") {
    const HandTape hand;
    const auto t = (hand.down() + hand.up()) * Recorded(0.0);
    const Attribution a = attribution_of(hand, t);
    CHECK(a.error == 0);
    CHECK(a.equal_culprits.empty());
}

TEST_CASE("ties: every form has the same culprit in every order of its tape", "[ties]") {
    SeenTies seen;
    Random random(31);
    const int rays = is_long() ? 20 : 3;
    for (const double far : {1.0, 100.0, 4000.0})
        on_recorded_rays({{"f32", "f64", "bf16", "p12"}, rays, far, 31},
                         [&](const Intersector& form, const Format&, const Setting&, const Tape& tape) {
                             demand_one_culprit(tape, form.shape == Shape::torus, random, seen);
                         });
    CHECK(seen.ties > 10 * rays);
    CHECK(seen.not_first > 7 * rays);
}

}  // namespace lostbits::test::test_ties
