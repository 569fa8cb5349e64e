// The claims as a document: README.md with every statement, its verdict, its number, and a picture of its subject.
#include <fmt/format.h>

#include <algorithm>

#include "output/claim/claim_files.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::claim {

std::vector<ClaimSubject> subjects_of(const std::vector<Claim>& claims) {
    std::vector<ClaimSubject> subjects;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        // One scene may have claims about its map, its rendering, and the rays that leave it.
        const std::string name = words_of(claims[i]).heading;
        auto found = std::ranges::find(subjects, name, &ClaimSubject::name);
        if (found == subjects.end()) found = subjects.insert(subjects.end(), {name, {}});
        found->claims.push_back(i);
    }
    return subjects;
}

namespace {

using State = ClaimResult::State;

/// Images for the screenshots of `lostbits report` that the folder has; tests/browser/screenshots.js takes them.
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

std::string code_list(const std::vector<std::string>& expressions) {
    std::string text;
    for (const std::string& expression : expressions)
        text += (text.empty() ? "" : ", ") + file::markdown_code(expression);
    return text;
}

std::string rounded(double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x) : file::decimal(x); }

/// ` (0.44 to 0.47 over 4 draws)`, or ` (in each of 4 draws)`; empty if nothing is random or only one draw was
/// measured.
std::string spread_text(const ClaimResult& r) {
    if (r.further_measured.empty()) return "";
    const auto s = r.spread();
    if (s.low == s.high) return fmt::format(" (in each of {} draws)", s.draws);
    return fmt::format(" ({} to {} over {} draws)", rounded(s.low), rounded(s.high), s.draws);
}

/// ` (95 %: 5.1 to 6.2)`, for a 99th percentile of random rays.
std::string bounds_text(const ClaimResult& r) {
    return r.bounds ? fmt::format(" (95 %: {} to {})", rounded(r.bounds->low), rounded(r.bounds->high)) : "";
}

/// Sentence on the number of random samples behind the claims of a subject; empty if nothing is random.
std::string samples_text(const ClaimSubject& subject, const std::vector<ClaimResult>& results) {
    for (const std::size_t i : subject.claims) {
        if (results[i].is_random())
            return fmt::format("*The rays or numbers are random. Each draw has {} independent samples.*\n\n",
                               results[i].samples);
    }
    return "";
}

/// Option of `lostbits check` that made the draws: ` --seeds 3`.
std::string draws_option(const std::vector<ClaimResult>& results) {
    std::size_t further = 0;
    for (const ClaimResult& r : results) further = std::max(further, r.further_measured.size());
    return further == 0 ? "" : fmt::format(" --seeds {}", further);
}

std::string claim_row_text(const Claim& c, const ClaimResult& r) {
    const std::string verdict =
        r.state == State::agrees
            ? (c.verdict == Claim::Verdict::refuted ? "**refuted**" : std::string(name_of(c.verdict)))
        : r.state == State::skipped ? "skipped"
                                    : fmt::format("**{}**", changed_text(c, r));
    // Expressions have stars, which Markdown would interpret.
    const std::string evidence = r.state == State::agrees ? evidence_text(c, r) : "";
    const std::string scope = floats_text(r) + (evidence.empty() ? "" : file::markdown_text(evidence)),
                      measured = r.floats > 0 ? file::decimal(r.measured) : rounded(r.measured);
    const std::string quantity_cell = c.operations.empty() ? file::markdown_text(quantity(c))
                                                           : fmt::format("{} of {}", c.metric, code_list(c.operations));
    const std::string position = words_of(c).place;
    const std::string quotation = c.quotation.empty() ? "" : " <br> \"" + file::markdown_text(c.quotation) + "\"";
    const std::string criterion = c.criterion ? "; says " + file::markdown_text(c.criterion->text) : "";
    return fmt::format(
        "| {}{} | {}{}{} | {} | {} = {}{} | {} |\n", verdict, scope.empty() ? "" : ": " + scope,
        file::markdown_text(c.statement), quotation,
        c.note.empty() ? "" : " <br> *" + file::markdown_text(c.note) + "*",
        file::markdown_text(fmt::format("{}{}{}", c.tested(), " " + c.format, position.empty() ? "" : ", " + position)),
        quantity_cell, measured + bounds_text(r) + spread_text(r), criterion, file::markdown_code(c.id));
}

}  // namespace

void write_claim_report(const std::filesystem::path& folder, const std::vector<Claim>& claims,
                        const std::vector<ClaimResult>& results, const ClaimRequest& run) {
    file::AtomicFile readme(folder / "README.md");
    const CountsBySource counts = count_verdicts(claims, results);
    const std::size_t unconfirmed_count = claims.size() - counts.all.confirmed();
    const auto quoted_count = std::ranges::count_if(claims, [](const Claim& c) { return !c.quotation.empty(); });
    std::string text = fmt::format(
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
    for (const ClaimSubject& subject : subjects_of(claims)) {
        text += fmt::format("\n## {}\n\n", file::markdown_text(subject.name));
        ShownSubject shown{folder, {}, run};
        for (const std::size_t i : subject.claims) shown.claims.push_back(&claims[i]);
        text += pictures_of(shown) + samples_text(subject, results);
        std::string source;
        for (const std::size_t i : subject.claims) {
            if (claims[i].source != source) {
                source = claims[i].source;
                text += fmt::format(
                    "{}Source: {}\n\n| verdict | sentence | measured on | measured | claim |\n|---|---|---|---|---|\n",
                    i == subject.claims.front() ? "" : "\n", source == "-" ? "our own" : file::markdown_text(source));
            }
            text += claim_row_text(claims[i], results[i]);
        }
    }
    readme.write(text);
    write_claims_csv(folder / "claims.csv", claims, results);
    readme.commit();
}

}  // namespace lostbits::output::claim
