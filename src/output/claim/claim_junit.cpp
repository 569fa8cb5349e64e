// Claims as JUnit XML.
#include <fmt/format.h>

#include <pugixml.hpp>

#include <sstream>

#include "output/claim/claim_files.hpp"
#include "output/claim/subject_words.hpp"
#include "output/claim/verdict_counts.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"

namespace lostbits::output::claim {

using measure::claim::ClaimResult;
using scene::claim::Claim;
using State = ClaimResult::State;

void write_junit(const std::filesystem::path& path, const std::vector<Claim>& claims,
                 const std::vector<ClaimResult>& results, bool strict,
                 const std::map<std::string, std::string>& moved) {
    pugi::xml_document document;
    auto suite = document.append_child("testsuites").append_child("testsuite");
    suite.append_attribute("name") = "lostbits claims";
    std::size_t failures = 0, errors = 0, skips = 0;
    const auto tests = suite.append_attribute("tests"), failed = suite.append_attribute("failures"),
               broken = suite.append_attribute("errors"), skipped = suite.append_attribute("skipped"),
               time = suite.append_attribute("time");
    double seconds = 0;
    const CountsBySource counts = count_verdicts(claims, results);
    auto properties = suite.append_child("properties");
    for (const auto& [name, text] :
         {std::pair{"from a source", counts.sourced.text()}, {"our own", counts.own.text()}}) {
        auto property = properties.append_child("property");
        property.append_attribute("name") = name;
        property.append_attribute("value") = text.c_str();
    }
    for (std::size_t i = 0; i < claims.size(); ++i) {
        const Claim& c = claims[i];
        auto test = suite.append_child("testcase");
        test.append_attribute("name") = file::xml_text(c.id).c_str();
        test.append_attribute("classname") = file::xml_text(c.subject_name()).c_str();
        test.append_attribute("time") = fmt::format("{:.6f}", results[i].seconds).c_str();
        seconds += results[i].seconds;
        if (const auto words = moved.find(c.id); words != moved.end()) {
            auto property = test.append_child("properties").append_child("property");
            property.append_attribute("name") = "moved";
            property.append_attribute("value") = file::xml_text(words->second).c_str();
        }
        if (results[i].state == State::agrees) continue;
        if (results[i].state == State::skipped) {
            ++skips;
            test.append_child("skipped").append_attribute("message") = file::xml_text(results[i].trouble).c_str();
            continue;
        }
        const std::string what = file::xml_text(explain(c, results[i]));
        const std::string more =
            file::xml_text(fmt::format("{}\n{}: {}\n{}\n{}\n{}\n", c.statement, c.where.text(), what,
                                       witness_text(results[i]), explain_witness(c, results[i]), words_of(c).command));
        if (c.severity == Claim::Severity::warn && !strict) {
            test.append_child("system-out").text().set(more.c_str());
            continue;
        }
        const bool is_failure = results[i].state == State::disagrees;
        ++(is_failure ? failures : errors);
        auto node = test.append_child(is_failure ? "failure" : "error");
        node.append_attribute("message") = what.c_str();
        node.text().set(more.c_str());
    }
    pugi::xml_attribute(time).set_value(fmt::format("{:.6f}", seconds).c_str());
    pugi::xml_attribute(tests).set_value(static_cast<unsigned long long>(claims.size()));
    pugi::xml_attribute(failed).set_value(static_cast<unsigned long long>(failures));
    pugi::xml_attribute(broken).set_value(static_cast<unsigned long long>(errors));
    pugi::xml_attribute(skipped).set_value(static_cast<unsigned long long>(skips));
    std::ostringstream text;
    document.save(text, "  ");
    file::write_file(path, text.str());
}

}  // namespace lostbits::output::claim
