// Measures claims about mending a form: the most accurate rewriting of its formula, and the number of operations that
// have to be wider.
#include <map>
#include <optional>
#include <tuple>

#include "measure/check/claim_subjects.hpp"
#include "measure/repair/repair.hpp"

namespace lostbits::measure::check {

using repair::RepairRequest;
using scene::check::Claim;
using scene::check::MendSubject;
using scene::file::Scene;

namespace {

/// A form that is mended, with the requirement of its claims.
class MendedForm {
public:
    MendedForm(const Claim& claim, const MendSubject& subject, const ClaimRequest& run)
        : scene_(load_single_scene(claim, run)) {
        if (subject.size) std::tie(scene_.width, scene_.height) = *subject.size;
        request_.scene = &scene_;
        request_.tested_form = tested_form_for(claim, scene_);
        request_.requirement = {.bits = subject.requirement.bits,
                                .max_wrong_fraction = subject.requirement.max_wrong_fraction};
        request_.requirement.quantile =
            find_for_claim(claim, [&] { return choose::parse_quantile(subject.requirement.quantile); });
        request_.limit.stop = run.stop;
        measurer_.emplace(request_);
        tape_ = find_for_claim(claim, [&] { return repair::record_tape(request_); });
        own_quality_ = find_for_claim(claim, [&] { return measure_own_quality(request_, tape_, *measurer_); });
    }

    /// Most accurate rewriting of the form; empty if no rewriting is more accurate than the form itself.
    std::optional<repair::RewrittenForm> best_rewriting() {
        if (!rewriting_) rewriting_ = rewrite(request_, tape_, own_quality_, *measurer_);
        return rewriting_->forms.empty() ? std::nullopt : std::optional(rewriting_->forms.front());
    }
    /// Number of operations in a smallest set that has to be wider: no operation of it can be left out. NaN if the
    /// requirement is not met even with all operations wider.
    double count_wider_operations() {
        if (own_quality_.meets(request_.requirement)) return 0;
        const FloatFormat wider = tape::wider_format(request_.tested_form.format.parameters, false);
        const auto quality_all_wider =
            measurer_->measure_quality({tape::widen_operations(tape_, tape::find_widenable_operations(tape_), wider)})
                .front();
        if (!quality_all_wider.meets(request_.requirement)) return truth::missing;
        return static_cast<double>(
            find_smallest_set(tape_, wider, quality_all_wider, request_, *measurer_, 0).operations.size());
    }

private:
    Scene scene_;
    RepairRequest request_{};
    std::optional<repair::QualityMeasurer> measurer_;
    Tape tape_;
    repair::FormQuality own_quality_{};
    std::optional<repair::RewritingResult> rewriting_;
};

double measured_value(const Claim& claim, MendedForm& form) {
    const auto value_of_rewritten = [&](const auto& value) {
        const auto rewriting = form.best_rewriting();
        return rewriting ? static_cast<double>(value(*rewriting)) : truth::missing;
    };
    if (claim.metric == "wrong_fraction")
        return value_of_rewritten([](const auto& r) { return r.quality.wrong_fraction(); });
    if (claim.metric == "kept_bits") return value_of_rewritten([](const auto& r) { return r.quality.kept_bits; });
    if (claim.metric == "operations")
        return value_of_rewritten([](const auto& r) { return r.rounding_operation_count; });
    if (claim.metric == "wider_operations") return form.count_wider_operations();
    scene::toml::fail(claim.quantity, "unknown metric \"" + claim.metric +
                                          "\"; for a form that is mended, write wrong_fraction, kept_bits or "
                                          "operations (of the best other way of writing it), or wider_operations");
}

}  // namespace

void measure(const SubjectClaims<MendSubject>& claims, const ClaimRequest& run) {
    // Claims about the same form, format, size and requirement are measured together.
    const auto measurement_key = [](const Claim& claim, const MendSubject& subject) {
        return std::tuple(claim.form, claim.format, subject.requirement.bits, subject.requirement.max_wrong_fraction,
                          subject.requirement.quantile, subject.size);
    };
    std::map<decltype(measurement_key(claims.front().claim, claims.front().subject)), SubjectClaims<MendSubject>>
        claims_by_key;
    for (const auto& subject_claim : claims)
        claims_by_key[measurement_key(subject_claim.claim, subject_claim.subject)].push_back(subject_claim);
    for (const auto& [key, key_claims] : claims_by_key) {
        MendedForm form(key_claims.front().claim, key_claims.front().subject, run);
        for (const auto& [claim, subject, result] : key_claims)
            result = judge_measured_value(claim, measured_value(claim, form), nullptr);
    }
}

}  // namespace lostbits::measure::check
