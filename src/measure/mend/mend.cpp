#include "measure/mend/mend.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "number/error.hpp"

namespace lostbits::measure::mend {

using scene::file::Scene;

namespace {

/// The scene in fewer pixels, an odd number each way, so that hardly a pixel lies where one did.
Scene in_other_pixels(Scene scene) {
    const auto fewer = [](int n) { return std::max(n * 7 / 8, 1) | 1; };
    scene.width = fewer(scene.width);
    scene.height = fewer(scene.height);
    return scene;
}

/// Where another way of writing alone does not meet the wish, the fewest of its operations wider, if they are fewer
/// than those of the form as it was.
void widen_where_needed(Rewritten& one, const Mended& m, const MendRequest& request, Judge& judge,
                        std::uint64_t affordable) {
    if (one.worth.meets(request.wish)) return;
    const Tape written = one.tape;
    const Worth all = judge.worth_of({tape::widened(written, tape::rounded_operations(written), m.wider)}).front();
    if (!all.meets(request.wish)) return;
    auto set = smallest_set(written, m.wider, all, request, judge, affordable);
    if (m.set && set.operations.size() >= m.set->operations.size()) return;
    one.tape = tape::widened(written, set.operations, m.wider);
    one.worth = set.worth;
    one.set = std::move(set);
}

}  // namespace

bool are_inverses(const MendRequest& request) {
    if (!request.row.form->is_placed) return false;
    std::set<int> kinds;
    const auto add = [&kinds](const auto& solids) {
        for (const auto& solid : solids) kinds.insert(!solid.placed ? 2 : solid.placed->is_inverse ? 1 : 0);
    };
    if (request.scene) add(request.scene->solids());
    else add(request.rays->sample.solids);
    if (kinds.size() == 1) return *kinds.begin() == 1;
    throw InputError(request.id() +
                     ": some solids stand under no matrix, or some matrices are stored as inverses and others are not: "
                     "each kind does other operations; mend the form for those of one kind");
}

Tape recorded(const MendRequest& request) {
    return tape::tape_of(*request.row.form, request.row.format, are_inverses(request));
}

Tape with_wider(const Mended& mended, const std::vector<NodeId>& operations) {
    return tape::widened(mended.tape, operations, mended.wider);
}

Mended mend(const MendRequest& request, std::uint64_t affordable) {
    Mended m{.tape = recorded(request), .wider = tape::wider_than(request.row.format.shape, request.two_words)};
    const std::vector<NodeId> all = tape::rounded_operations(m.tape);
    m.operations = all.size();
    Judge judge(request);
    m.own = own_worth(request, m.tape, judge);
    m.all = judge.worth_of({with_wider(m, all)}).front();
    if (m.own.meets(request.wish)) m.set = WiderSet{.operations = {}, .worth = m.own};
    else if (m.all.meets(request.wish)) m.set = smallest_set(m.tape, m.wider, m.all, request, judge, affordable);
    if (!m.own.meets(request.wish)) m.rewriting = rewrite(request, m.tape, m.own, judge);
    for (Rewritten& one : m.rewriting.found) widen_where_needed(one, m, request, judge, affordable);
    m.tried = judge.tried();
    std::vector<Tape> asked{m.tape, with_wider(m, m.set ? m.set->operations : all)};
    for (const Rewritten& r : m.rewriting.found) asked.push_back(r.tape);
    if (request.scene) m.apart = in_other_pixels(*request.scene);
    const auto there = request.scene ? Judge(request, m.apart).worth_of(asked) : request.on_all(asked);
    m.own_apart = there[0];
    m.apart_worth = there[1];
    for (std::size_t k = 2; k < there.size(); ++k) m.rewriting.found[k - 2].apart = there[k];
    return m;
}

}  // namespace lostbits::measure::mend
