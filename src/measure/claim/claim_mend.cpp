// Claims about what mending makes of a form: the most accurate other way of writing it, and how many operations must be
// wider.
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "measure/claim/claim_subjects.hpp"
#include "measure/mend/mend.hpp"

namespace lostbits::measure::claim {

using mend::MendRequest;
using scene::claim::Claim;
using scene::file::Scene;

namespace {

/// A form that is mended, as its claims ask.
class Bench {
public:
    Bench(const Claim& claim, const ClaimRequest& run) : scene_(scene_of(claim, run)) {
        request_.scene = &scene_;
        request_.row = row_for(claim, scene_);
        request_.wish = {.bits = claim.mend->bits, .wrong = claim.mend->wrong};
        request_.wish.quantile = find_or_blame_claim(claim, [&] { return choice::quantile_named(claim.mend->at); });
        request_.limit.stop = run.stop;
        judge_.emplace(request_);
        tape_ = find_or_blame_claim(claim, [&] { return mend::recorded(request_); });
        own_ = find_or_blame_claim(claim, [&] { return own_worth(request_, tape_, *judge_); });
    }

    /// The most accurate other way of writing it; nothing where none is more accurate.
    std::optional<mend::Rewritten> rewritten() {
        if (!rewriting_) rewriting_ = rewrite(request_, tape_, own_, *judge_);
        return rewriting_->found.empty() ? std::nullopt : std::optional(rewriting_->found.front());
    }
    /// The operations of a set from which none can be taken; NaN where it does not meet the wish with all of them.
    double wider_operations() {
        if (own_.meets(request_.wish)) return 0;
        const FloatFormat wider = tape::wider_than(request_.row.format.shape, false);
        const auto all = judge_->worth_of({tape::widened(tape_, tape::rounded_operations(tape_), wider)}).front();
        if (!all.meets(request_.wish)) return truth::missing;
        return static_cast<double>(smallest_set(tape_, wider, all, request_, *judge_, 0).operations.size());
    }

private:
    static Scene scene_of(const Claim& claim, const ClaimRequest& run) {
        Scene scene = one_scene(claim, claim.mend->scene, run);
        if (claim.mend->size) std::tie(scene.width, scene.height) = *claim.mend->size;
        return scene;
    }

    Scene scene_;
    MendRequest request_{};
    std::optional<mend::Judge> judge_;
    Tape tape_;
    mend::Worth own_{};
    std::optional<mend::Rewriting> rewriting_;
};

double value_of(const Claim& claim, Bench& bench) {
    const auto of_rewritten = [&](const auto& value) {
        const auto found = bench.rewritten();
        return found ? static_cast<double>(value(*found)) : truth::missing;
    };
    if (claim.metric == "wrong_fraction") return of_rewritten([](const auto& r) { return r.worth.wrong_fraction(); });
    if (claim.metric == "kept_bits") return of_rewritten([](const auto& r) { return r.worth.kept_bits; });
    if (claim.metric == "operations") return of_rewritten([](const auto& r) { return r.operations; });
    if (claim.metric == "wider_operations") return bench.wider_operations();
    scene::toml::fail(claim.quantity, "unknown metric \"" + claim.metric +
                                          "\"; of a form that is mended there are wrong_fraction, kept_bits and "
                                          "operations of the best that it is written as, and wider_operations");
}

}  // namespace

void measure_mend(const std::vector<Claim>& claims, const Places& places, const ClaimRequest& run,
                  std::vector<ClaimResult>& results) {
    // Claims that ask the same of a form are measured together.
    const auto asked = [&](std::size_t i) {
        const Claim& c = claims[i];
        return std::tuple(c.form, c.format, c.mend->bits, c.mend->wrong, c.mend->at, c.mend->size);
    };
    std::map<decltype(asked(0)), Places> alike;
    for (const std::size_t i : places) alike[asked(i)].push_back(i);
    for (const auto& [what, some] : alike) {
        Bench bench(claims[some.front()], run);
        for (const std::size_t i : some) results[i] = judge(claims[i], value_of(claims[i], bench), nullptr);
    }
}

}  // namespace lostbits::measure::claim
