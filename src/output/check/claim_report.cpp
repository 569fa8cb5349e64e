// The claims as a document: README.md with every statement, its verdict, its number, and a picture of its subject.
#include <fmt/format.h>

#include <algorithm>

#include "output/check/claim_files.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::check {

std::vector<ClaimSubject> group_by_subject(const std::vector<Claim>& claims) {
    std::vector<ClaimSubject> subjects;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        // One scene may have claims about its map, its rendering, and the rays that leave it.
        const std::string name = subject_texts(claims[i]).heading;
        auto found = std::ranges::find(subjects, name, &ClaimSubject::name);
        if (found == subjects.end()) found = subjects.insert(subjects.end(), {name, {}});
        found->claims.push_back(i);
    }
    return subjects;
}

namespace {

using State = ClaimResult::State;

/// Markdown that shows the screenshots of `lostbits report` in the folder; tests/browser/screenshots.js takes them.
std::string screenshots_in(const std::filesystem::path& folder) {
    std::string text;
    for (const auto& [name, caption] : {std::pair{"maps", "Lost bits of two forms side by side, and one ray"},
                                        std::pair{"operations", "Culprits, and the operations of one ray"},
                                        std::pair{"sweeps", "Lost bits along a parameter"},
                                        std::pair{"claims", "Claims; each leads to its pixels or its plot"}}) {
        const std::string file = fmt::format("screenshots/{}.png", name);
        if (std::filesystem::exists(folder / file)) text += fmt::format("\n![{}]({})\n", caption, file);
    }
    return text.empty() ? "" : "\nThe page looks like this:\n" + text;
}

std::string expression_list(const std::vector<std::string>& expressions) {
    std::string text;
    for (const std::string& expression : expressions)
        text += (text.empty() ? "" : ", ") + file::markdown_code(expression);
    return text;
}

std::string short_number(double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x) : file::decimal(x); }

/// Range of a number over the draws: ` (0.44 to 0.47 over 4 draws)` or ` (in each of 4 draws)`. Empty if nothing is
/// random or only one draw was measured.
std::string spread_text(const ClaimResult& result) {
    if (result.further_measured.empty()) return "";
    const auto s = result.spread();
    if (s.low == s.high) return fmt::format(" (in each of {} draws)", s.draws);
    return fmt::format(" ({} to {} over {} draws)", short_number(s.low), short_number(s.high), s.draws);
}

/// Confidence bounds of a 99th percentile of random rays: ` (95 %: 5.1 to 6.2)`.
std::string bounds_text(const ClaimResult& result) {
    return result.bounds
               ? fmt::format(" (95 %: {} to {})", short_number(result.bounds->low), short_number(result.bounds->high))
               : "";
}

/// Sentence on the number of random samples behind the claims of a subject; empty if nothing is random.
std::string samples_text(const ClaimSubject& subject, const std::vector<ClaimResult>& results) {
    for (const std::size_t i : subject.claims) {
        if (results[i].is_random())
            return fmt::format("*The rays or numbers are random. Each draw has {} independent samples.*\n\n",
                               results[i].sample_count);
    }
    return "";
}

/// Option of `lostbits check` that made the draws: ` --seeds 3`.
std::string draws_option(const std::vector<ClaimResult>& results) {
    std::size_t further_draw_count = 0;
    for (const ClaimResult& result : results)
        further_draw_count = std::max(further_draw_count, result.further_measured.size());
    return further_draw_count == 0 ? "" : fmt::format(" --seeds {}", further_draw_count);
}

std::string claim_row_text(const Claim& claim, const ClaimResult& result) {
    const std::string verdict =
        result.state == State::agrees
            ? (claim.verdict == Claim::Verdict::refuted ? "**refuted**" : std::string(name_of(claim.verdict)))
        : result.state == State::skipped ? "skipped"
                                         : fmt::format("**{}**", disagreement_text(claim, result));

    // Expressions have stars, which Markdown would interpret.
    const std::string evidence = result.state == State::agrees ? evidence_text(claim, result) : "";
    const std::string scope = floats_text(result) + (evidence.empty() ? "" : file::markdown_text(evidence)),
                      measured =
                          result.float_count > 0 ? file::decimal(result.measured) : short_number(result.measured);
    const std::string quantity_cell = claim.operations.empty()
                                          ? file::markdown_text(quantity_text(claim))
                                          : fmt::format("{} of {}", claim.metric, expression_list(claim.operations));

    const std::string position = subject_texts(claim).position;
    const std::string quotation =
        claim.quotation.empty() ? "" : " <br> \"" + file::markdown_text(claim.quotation) + "\"";
    const std::string criterion = claim.criterion ? "; says " + file::markdown_text(claim.criterion->text) : "";

    return fmt::format("| {}{} | {}{}{} | {} | {} = {}{} | {} |\n", verdict, scope.empty() ? "" : ": " + scope,
                       file::markdown_text(claim.statement), quotation,
                       claim.note.empty() ? "" : " <br> *" + file::markdown_text(claim.note) + "*",
                       file::markdown_text(fmt::format("{}{}{}", claim.tested_name(), " " + claim.format,
                                                       position.empty() ? "" : ", " + position)),
                       quantity_cell, measured + bounds_text(result) + spread_text(result), criterion,
                       file::markdown_code(claim.id));
}

/// Title of the document, and the paragraphs on how to read it.
std::string introduction(const std::filesystem::path& folder, const std::vector<Claim>& claims,
                         const std::vector<ClaimResult>& results) {
    const CountsBySource counts = count_verdicts(claims, results);
    const std::size_t unconfirmed_count = claims.size() - counts.all.agreeing_count();
    const auto quoted_count =
        std::ranges::count_if(claims, [](const Claim& claim) { return !claim.quotation.empty(); });
    return fmt::format(
        "# What the sources say, and what we measured\n\nMade by `lostbits check{} --report reports`; do not edit. "
        "{} claims, each a sentence or a part of one{}: {}. A statement is qualified if it is true under a condition "
        "that its source does not state. Words of the source, found there by a second person, stand below {} of the "
        "sentences. The verdicts on {} follow from what the statement says about the number "
        "(\"says = 0\"); the others only describe a number. Every number was measured by the run that made this "
        "page; a test makes the page again and compares. `lostbits report` makes the same page for a browser, where "
        "each claim links to its pixels or its plot.\n\nClaims about random rays were measured on several draws. All "
        "must lie in the claim's interval, which is the range over 32 draws, widened by half on either side (in "
        "logarithms for onsets and fractions).\n{}",
        draws_option(results), claims.size(),
        unconfirmed_count == 0 ? "" : fmt::format(", of which {} failed or could not be measured", unconfirmed_count),
        counts.text(), quoted_count, counts.all.with_criterion, screenshots_in(folder));
}

/// Tables of the claims about a subject: one for each run of claims from the same source.
std::string subject_tables(const ClaimSubject& subject, const std::vector<Claim>& claims,
                           const std::vector<ClaimResult>& results) {
    std::string text, source;
    for (const std::size_t i : subject.claims) {
        if (claims[i].source != source) {
            source = claims[i].source;
            text += fmt::format(
                "{}Source: {}\n\n| verdict | sentence | measured on | measured | claim |\n|---|---|---|---|---|\n",
                i == subject.claims.front() ? "" : "\n", source == "-" ? "our own" : file::markdown_text(source));
        }
        text += claim_row_text(claims[i], results[i]);
    }
    return text;
}

}  // namespace

void write_claim_report(const std::filesystem::path& folder, const std::vector<Claim>& claims,
                        const std::vector<ClaimResult>& results, const ClaimRequest& request) {
    file::AtomicFile readme(folder / "README.md");
    std::string text = introduction(folder, claims, results);
    for (const ClaimSubject& subject : group_by_subject(claims)) {
        text += fmt::format("\n## {}\n\n", file::markdown_text(subject.name));
        ShownSubject shown{folder, {}, request};
        for (const std::size_t i : subject.claims) shown.claims.push_back(&claims[i]);
        text += draw_subject_pictures(shown) + samples_text(subject, results);
        text += subject_tables(subject, claims, results);
    }

    readme.write(text);
    write_claims_csv(folder / "claims.csv", claims, results);
    readme.commit();
}

}  // namespace lostbits::output::check
