// Measures claims about studies: each is about one number of one row of a summary.
#include "measure/claim/claim_studies.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "measure/claim/claim_subjects.hpp"

namespace lostbits::measure::claim {

using scene::claim::Claim;
using scene::claim::StudySubject;

namespace {

using StudyClaim = SubjectClaim<StudySubject>;
using Words = std::map<std::string, std::string>;

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

/// The words of a claim's options. Those that are columns of the summary too choose a row of it, so claims with
/// different ones can be measured together.
struct OptionsOfClaim {
    Words together, apart;
};
OptionsOfClaim options_of(const StudyClaim& asked, const StudyNames& names) {
    OptionsOfClaim options;
    for (const auto& [name, word] : asked.on.options)
        (has(names.words, name) ? options.together : options.apart)[name] = word;
    return options;
}

void require_names(const StudyClaim& asked, const StudyNames& names) {
    const auto require_known = [&](const Words& words, const char* what, const std::vector<std::string>& known) {
        for (const auto& [name, word] : words)
            if (!has(known, name))
                scene::toml::fail(asked.claim.where, fmt::format("study {} has no {} \"{}\"; {}", asked.on.study, what,
                                                                 name, scene::toml::did_you_mean(name, known)));
    };
    require_known(asked.on.options, "option", names.options);
    require_known(asked.on.where, "column of words", names.words);
    if (!has(names.numbers, asked.claim.metric))
        scene::toml::fail(asked.claim.where,
                          fmt::format("unknown metric \"{}\" of study {}; {}", asked.claim.metric, asked.on.study,
                                      scene::toml::did_you_mean(asked.claim.metric, names.numbers)));
}

/// The words that the row of a claim has in the summary.
Words words_of_row(const StudyClaim& asked, const StudyNames& names) {
    Words words = options_of(asked, names).together;
    words.insert(asked.on.where.begin(), asked.on.where.end());
    words["form"] = asked.claim.form;
    words["format"] = asked.claim.format;
    return words;
}

std::string listed(const Words& words) {
    std::vector<std::string> each;
    for (const auto& [name, word] : words) each.push_back(fmt::format("{} = \"{}\"", name, word));
    return fmt::format("{}", fmt::join(each, ", "));
}

/// The one row that a claim is about.
const StudyRow& row_of(const StudyClaim& asked, const StudyNames& names, const std::vector<StudyRow>& rows) {
    const Words words = words_of_row(asked, names);
    const StudyRow* found = nullptr;
    std::set<std::string> differing;
    for (const StudyRow& row : rows) {
        if (std::ranges::any_of(words, [&](const auto& word) { return row.words.at(word.first) != word.second; }))
            continue;
        if (found != nullptr)
            for (const std::string& name : names.words) {
                const std::string &one = found->words.at(name), &other = row.words.at(name);
                if (one != other && one.find(' ') == std::string::npos) differing.insert(name);  // commands have blanks
            }
        found = &row;
    }
    if (found == nullptr) {
        std::set<std::string> others;
        for (const auto& [name, word] : words)
            for (const StudyRow& row : rows)
                if (row.words.at(name) != word) others.insert(fmt::format("{} = \"{}\"", name, row.words.at(name)));
        scene::toml::fail(
            asked.claim.where,
            fmt::format("the summary of {} has no row with {}; {}", asked.on.study, listed(words),
                        others.empty() ? "it is empty" : fmt::format("there is {}", fmt::join(others, ", "))));
    }
    if (!differing.empty())
        scene::toml::fail(asked.claim.where,
                          fmt::format("several rows of the summary of {} have {}; say which one is meant, by {}",
                                      asked.on.study, listed(words), fmt::join(differing, ", ")));
    return *found;
}

void judge_claim(const StudyClaim& asked, const StudyRow& row) {
    ClaimResult& result = asked.result;
    result = judge(asked.claim, row.numbers.at(asked.claim.metric), nullptr);
    if (const auto witness = row.witnesses.find(asked.claim.metric); witness != row.witnesses.end())
        result.witness = witness->second;
    require_proof(result, row.unproved, "pixel has no proved truth", "pixels have no proved truth");
}

/// Claims that one run of a study measures.
struct OneRun {
    SubjectClaims<StudySubject> claims = {};
    std::vector<evaluate::TestedForm> rows = {};
};

/// Puts claims whose rows need the same options into one run. `claims` have the same study and options `apart`.
std::map<std::map<std::string, std::set<std::string>>, OneRun> runs_of(const SubjectClaims<StudySubject>& claims,
                                                                       const StudyNames& names) {
    std::vector<evaluate::TestedForm> rows;
    std::vector<std::map<std::string, std::set<std::string>>> options;
    for (const StudyClaim& asked : claims) {
        const std::size_t place = place_or_added(rows, claim_row(asked.claim));
        options.resize(rows.size());
        for (const auto& [name, word] : options_of(asked, names).together) options[place][name].insert(word);
    }
    std::map<std::map<std::string, std::set<std::string>>, OneRun> runs;
    for (const StudyClaim& asked : claims) {
        const evaluate::TestedForm row = claim_row(asked.claim);
        OneRun& run = runs[options[place_or_added(rows, row)]];
        run.claims.push_back(asked);
        place_or_added(run.rows, row);
    }
    return runs;
}

/// Measures claims about one study whose options `apart` are the same.
void measure_together(const SubjectClaims<StudySubject>& claims, const Words& apart, const StudyNames& names,
                      const scene::file::Scene& scene, const ClaimRequest& run) {
    for (auto& [together, one] : runs_of(claims, names)) {
        StudyQuestion question{.scene = scene, .rows = one.rows, .stop = run.stop};
        for (const auto& [name, word] : apart) question.options[name] = {word};
        for (const auto& [name, words] : together) question.options[name].assign(words.begin(), words.end());
        for (const StudyClaim& asked : one.claims) question.columns.insert(asked.claim.metric);
        const auto rows = find_for_claim(one.claims.front().claim,
                                         [&] { return run.studies->measure(one.claims.front().on.study, question); });
        for (const StudyClaim& asked : one.claims) judge_claim(asked, row_of(asked, names, rows));
    }
}

}  // namespace

void measure(const SubjectClaims<StudySubject>& claims, const ClaimRequest& run) {
    const scene::file::Scene scene = one_scene(claims.front().claim, run);
    std::map<std::string, StudyNames> names;
    std::map<std::pair<std::string, Words>, SubjectClaims<StudySubject>> alike;
    for (const StudyClaim& asked : claims) {
        const std::string& study = asked.on.study;
        row_for(asked.claim, scene);  // throws, with the position of this claim, before the measurement starts
        if (!names.contains(study))
            names[study] = find_for_claim(asked.claim, [&] { return run.studies->names(study); });
        require_names(asked, names.at(study));
        alike[{study, options_of(asked, names.at(study)).apart}].push_back(asked);
    }
    for (const auto& [key, some] : alike) measure_together(some, key.second, names.at(key.first), scene, run);
}

}  // namespace lostbits::measure::claim
