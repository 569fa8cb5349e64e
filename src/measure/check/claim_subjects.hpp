// Measures claims about one subject together.
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <vector>

#include "intersect/process/parallel.hpp"
#include "measure/check/claim.hpp"
#include "number/error.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::measure::check {

/// Index of a name in a list. Throws InputError with the claim's position for an unknown name.
template <class List, class Name = std::identity>
std::size_t index_of_name(const scene::check::Claim& claim, const char* kind, const std::string& text, const List& list,
                          Name name = {}) {
    std::vector<std::string> names;
    for (const auto& item : list) names.emplace_back(std::invoke(name, item));
    const auto found = std::ranges::find(names, text);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    scene::toml::fail(claim.where,
                      "unknown " + std::string(kind) + " \"" + text + "\"; " + text::did_you_mean(text, names));
}

/// A claim, its subject, and its result.
template <class Kind>
struct SubjectClaim {
    const scene::check::Claim& claim;
    const Kind& subject;
    ClaimResult& result;
};
/// Claims about one scene, sweep or table, measured together.
template <class Kind>
using SubjectClaims = std::vector<SubjectClaim<Kind>>;

/// Measures claims about one subject; there is one function for each kind of subject.
void measure(const SubjectClaims<scene::check::SceneSubject>& claims, const ClaimRequest& run);
void measure(const SubjectClaims<scene::check::SweepSubject>& claims, const ClaimRequest& run);
void measure(const SubjectClaims<scene::check::StudySubject>& claims, const ClaimRequest& run);
void measure(const SubjectClaims<scene::check::SearchSubject>& claims, const ClaimRequest& run);
void measure(const SubjectClaims<scene::check::MendSubject>& claims, const ClaimRequest& run);
void measure(const SubjectClaims<scene::check::TableSubject>& claims, const ClaimRequest& run);
void measure(const SubjectClaims<scene::check::TimingSubject>& claims, const ClaimRequest& run);
void measure(const SubjectClaims<scene::check::ChoiceSubject>& claims, const ClaimRequest& run);

/// Measures claims about a sweep over every float, which is in the file `path`.
void measure_exhaustive(const SubjectClaims<scene::check::SweepSubject>& claims, const std::filesystem::path& path,
                        const ClaimRequest& run);

/// Measures what changes if the nearest hit so far is passed on: each box in turn gets the closest t so far as the end
/// of the ray. The rays are seeded rays of `scene::box::BoxDistribution`, aimed at the shared edges of eight adjoining
/// boxes from `distance` sizes away. Returns the share of the rays on which the nearest t over all boxes, or the
/// decision, then differs.
double measure_closest_t_difference(const evaluate::TestedForm& tested_form, double distance, std::uint64_t seed,
                                    truth::ProofLimit limit);

/// Adds the result of a further draw: a claim holds only if it holds for every draw.
void add_draw(ClaimResult& result, const ClaimResult& draw);

/// Measures claims on the subject's own draw and on further draws, with `measure_draw(claims, draw)`. `draw` is 0 for
/// the subject's own seed, 1 for the next one, and so on.
template <class Kind, class Measure>
void measure_draws(const SubjectClaims<Kind>& claims, const ClaimRequest& run, const Measure& measure_draw) {
    measure_draw(claims, 0);
    const bool is_any_random =
        std::ranges::any_of(claims, [](const SubjectClaim<Kind>& claim) { return claim.result.is_random(); });
    const auto further_draw_count = static_cast<std::size_t>(is_any_random ? run.further_draw_count : 0);
    std::vector<std::vector<ClaimResult>> draws(further_draw_count, std::vector<ClaimResult>(claims.size()));
    intersect::process::in_parallel(std::size_t{0}, further_draw_count, [&](std::size_t d) {
        SubjectClaims<Kind> draw_claims;
        for (std::size_t i = 0; i < claims.size(); ++i)
            draw_claims.push_back({claims[i].claim, claims[i].subject, draws[d][i]});
        measure_draw(draw_claims, static_cast<int>(d) + 1);
    });
    for (const auto& draw : draws) {
        for (std::size_t i = 0; i < claims.size(); ++i) {
            if (claims[i].result.is_random()) add_draw(claims[i].result, draw[i]);
        }
    }
}

/// Loads the scene that is the subject of a claim. Throws InputError with the claim's position.
scene::file::Scene load_single_scene(const scene::check::Claim& claim, const ClaimRequest& run);

/// Compares a measurement with the expectation of a claim. `summary` (may be null) is the source of the number.
ClaimResult judge_measured_value(const scene::check::Claim& claim, double measured,
                                 const evaluate::FormSummary* summary);

/// Marks the result as unmeasurable if some truths are not proved. The reason is "1 pixel has no proved truth" or "3
/// pixels have …".
void mark_if_unproved(ClaimResult& result, std::uint64_t unproved_count, const char* singular_text,
                      const char* plural_text);

/// The format of a claim. Throws InputError for an unknown name.
Format claim_format(const scene::check::Claim& claim);

/// Index of a tested form in `tested_forms`, to which it is added if it is new.
inline std::size_t find_or_add_tested_form(std::vector<evaluate::TestedForm>& tested_forms,
                                           const evaluate::TestedForm& tested_form) {
    const auto found = std::ranges::find(tested_forms, tested_form);
    if (found != tested_forms.end()) return static_cast<std::size_t>(found - tested_forms.begin());
    tested_forms.push_back(tested_form);
    return tested_forms.size() - 1;
}

template <class Kind>
std::vector<const scene::check::Claim*> claim_pointers(const SubjectClaims<Kind>& claims) {
    std::vector<const scene::check::Claim*> result;
    for (const SubjectClaim<Kind>& claim : claims) result.push_back(&claim.claim);
    return result;
}

/// Form and format of a claim about a scene or sweep. Throws InputError if the form cannot handle it.
template <class Rays>
evaluate::TestedForm tested_form_for(const scene::check::Claim& claim, const Rays& rays) {
    const evaluate::TestedForm tested_form = tested_form_of(claim);
    if (rays.accepts(tested_form.form->shapes())) return tested_form;
    scene::toml::fail(claim.where,
                      claim.form + " cannot handle " + claim.subject_name() + ": it has " +
                          (!is_primitive(tested_form.form->shape) ? "no [march] table" : "other primitives") +
                          "; name another form, or another scene or sweep");
}

/// Result of `find`. If `find` throws InputError, the claim's position is put in front of the message.
template <class Find>
auto find_for_claim(const scene::check::Claim& claim, const Find& find) {
    try {
        return find();
    } catch (const InputError& error) {
        scene::toml::fail(claim.where, error.what());
    }
}

}  // namespace lostbits::measure::check
