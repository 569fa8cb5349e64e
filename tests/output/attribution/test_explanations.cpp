// Explanations of rays of every kind: text, JSON and table say the same about a ray, and sentences contain only finite
// numbers.
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/table/in_range.hpp"
#include "measure/answer/answers.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "measure/rows.hpp"
#include "number/oracle.hpp"
#include "output/attribution/explain_text.hpp"

namespace lostbits::test::test_explanations {

using intersect::Touching;
using intersect::table::Intersector;
using measure::answer::OneRay;
using measure::answer::Outcome;
using measure::attribution::Explanation;
using output::attribution::ExplainedVerdict;
using output::attribution::MarchEnd;

namespace {

struct RayQuestion {
    const Intersector* form;
    Format format;
    scene::rays::RayGroup group;
    std::optional<Touching> judged = {};
    [[nodiscard]] OneRay ray() const {
        OneRay one{scene::rays::RayGroup(group)};
        one.set_touching(judged);
        return one;
    }
};

/// An explained ray in each of its outputs.
struct ShownRay {
    OneRay ray;
    Explanation x;
    std::optional<MarchEnd> march;
    ExplainedVerdict verdict;
    std::string text;
    nlohmann::json json;

    explicit ShownRay(const RayQuestion& of)
        : ray(of.ray()),
          x(measure::attribution::explain_alone(*of.form, of.format, ray)),
          march(output::attribution::find_march_end(*of.form, of.format, ray)),
          verdict(output::attribution::make_verdict(x, march)),
          text(output::attribution::explain_text(x, true, march)),
          json(nlohmann::json::parse(output::attribution::explain_json(x, march))) {}
    [[nodiscard]] bool says(const std::string& part) const { return text.find(part) != std::string::npos; }
};

std::size_t below(Random& random, std::size_t n) {
    return static_cast<std::size_t>(random.between(0, static_cast<long>(n) - 1));
}

/// Numbers, some of them degenerate: zeros, very far, very small. One ray in three has two primitives.
RayQuestion draw(Random& random, const Intersector& form, const Format& format) {
    constexpr std::array far{1.0, 1.0, 30.0, 2000.0};
    Setting s = draw_setting(random, form, format, far[below(random, far.size())]);
    const auto in_format = [&](double x) { return rounding::to_format(x, 0, format.parameters); };
    constexpr std::array odd{0.0, 0.0, 1.0, -1.0, 0x1p-60, 0x1p+20, 0x1p-120, 0x1p+100};
    for (Vec<double>* const v : {&s.ray.origin, &s.ray.direction})
        for (int k = 0; k < 3; ++k)
            if (below(random, 8) == 0) (*v)[k] = in_format(odd[below(random, odd.size())]);
    if (s.ray.direction == Vec<double>(0, 0, 0)) s.ray.direction.x = 1;
    RayQuestion question{&form, format, scene::rays::make_group(s.ray)};
    question.group.primitives = s.primitives;
    if (is_primitive(form.shape) && random.one_in(3))
        question.group.primitives.push_back(draw_setting(random, form, format, 1).primitives.front());
    if (!is_primitive(form.shape)) question.group.march = s.march;
    constexpr std::array<std::optional<Touching>, 3> judged{std::nullopt, Touching::hit, Touching::miss};
    question.judged = judged[below(random, judged.size())];
    return question;
}

/// A range that ends or begins near a root, so that rounding may decide.
Range<double> draw_range(Random& random, const Explanation& explanation) {
    const auto& f = explanation.format.parameters;
    const auto near = [&](double t) {
        if (!std::isfinite(t) || t < 0) t = random.unit();
        for (std::size_t k = below(random, 4); k > 0; --k) t = rounding::next_up(t, f);
        for (std::size_t k = below(random, 4); k > 0 && t > 0; --k) t = -rounding::next_up(-t, f);
        return t;
    };
    const TapeOutputs& at = explanation.tape.outputs;
    const double roots[] = {explanation.tape[at.t].value, explanation.tape[at.near].value,
                            explanation.tape[at.far].value, explanation.attribution[at.t].exact,
                            explanation.attribution[at.far].exact};
    const auto root = [&] { return near(rounding::to_format(roots[below(random, 5)], 0, f)); };
    Range<double> range;
    if (below(random, 3) != 0) range.tmin = root();
    if (below(random, 3) != 0) range.tmax = root();
    range.open_ends = open_ends_names[below(random, 4)].second;
    return range;
}

/// Calls `see(asked, shown)` for many rays: each as it is, and with two ranges. The long tests take every form in every
/// format; the short tests take a third of the forms in each format.
template <class See>
void on_explained_rays(int rays, std::uint64_t seed, const See& see) {
    Random random(seed);
    constexpr std::array formats{"f32", "p12", "f64"};
    std::size_t place = 0;
    for (const Intersector& form : intersect::table::catalogue()) {
        ++place;
        for (std::size_t f = 0; f < formats.size(); ++f) {
            const char* const name = formats[f];
            const Format format = *find_format(name);
            if (!form.exists_in(format) || (!is_long() && (place + seed) % formats.size() != f)) continue;
            for (int i = 0; i < rays; ++i) {
                RayQuestion question = draw(random, form, format);
                INFO(form.info->name << " in " << name << ", ray " << i);
                const ShownRay plain(question);
                see(question, plain);
                for (int k = 0; k < 2; ++k) {
                    const Range<double> range = draw_range(random, plain.x);
                    question.group.rays.tmin = {range.tmin};
                    question.group.rays.tmax = {range.tmax};
                    question.group.rays.open_ends = range.open_ends;
                    INFO("from " << range.tmin << " to " << range.tmax << ", open " << name_of(range.open_ends));
                    see(question, ShownRay(question));
                }
            }
        }
    }
}

std::vector<std::string> split_lines(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

/// The decision without rounding, by the tape, which has no range, and the function that batches call.
std::optional<bool> exact_decision(const RayQuestion& question, const Explanation& explanation) {
    const OneRay ray = question.ray();
    const OneRay::Inputs in = ray.inputs(*question.form, question.format);
    const auto aim = in.format_inputs.target_for(*question.form, static_cast<std::size_t>(explanation.primitive_index));
    Tape tape;
    question.form->record(question.format, in.ray(*question.form->info), aim, explanation.range.tmax, tape);
    const auto found = measure::attribution::attribute(tape, {.full = true});
    double t = found[tape.outputs.t].exact, near = found[tape.outputs.near].exact, far = found[tape.outputs.far].exact;
    for (const double root : {t, near, far})  // rounded to a double, it may be on the other side
        for (const double end : {explanation.range.tmin, explanation.range.tmax})
            if (std::fabs(root - end) <= 0x1p-50 * std::fabs(end)) return {};
    std::uint8_t hit = found.is_exact_hit;
    const auto one = [](double& v) { return std::span<double>(&v, 1); };
    double begin = explanation.range.tmin, end = explanation.range.tmax, zero = 0;
    const intersect::table::RayBatch<double> batch{one(zero), one(zero),  one(zero),
                                                   one(zero), one(zero),  one(zero),
                                                   one(end),  one(begin), explanation.range.open_ends};
    intersect::table::limit_batch_to_range<double>(*question.form->info, question.form->shape, batch,
                                                   {one(t), one(near), one(far), std::span(&hit, 1)});
    return hit != 0;
}

const std::regex& raw_number() {
    static const std::regex found(R"((^|[^\w.])-?(inf|nan)($|[^\w(]))");
    return found;
}

}  // namespace

TEST_CASE("explained rays have the same verdict as text, JSON and table for every ray, range and convention") {
    std::map<std::string, int> seen;
    on_explained_rays(is_long() ? 40 : 2, 65, [&](const RayQuestion&, const ShownRay& shown) {
        INFO(shown.text);
        for (const auto& [key, says] : {std::pair{"answer", shown.verdict.answer},
                                        {"verdict", shown.verdict.loss},
                                        {"sentence", shown.verdict.blame}}) {
            REQUIRE(shown.json[key] == says);
            REQUIRE(shown.says(says + "\n"));
        }
        // The culprit is the row with the star, and the sentence names it; else there is neither.
        std::string starred;
        for (const std::string& line : split_lines(shown.text))
            if (line.starts_with("* ") && !line.starts_with("* marks")) starred = line.substr(2, line.find(' ', 2) - 2);
        REQUIRE(shown.json["culprit"].is_null() == starred.empty());
        if (!starred.empty()) REQUIRE(shown.json["culprit"] == starred);
        REQUIRE(shown.says("* marks the culprit") == !starred.empty());
        const std::string& blame = shown.verdict.blame;
        const auto has = [&blame](const char* words) { return blame.find(words) != std::string::npos; };
        if (starred.empty()) CHECK_FALSE(has("The culprit is"));
        if (has("o operation is to blame") || has("No operation rounded")) CHECK(starred.empty());
        // The words about decisions agree with the two runs, and with the table.
        const bool hit = shown.json["hit"], exact = shown.json["attribution"]["exact_hit"],
                   cut = shown.x.attribution.loop_was_cut_short;
        if (has("is the same without rounding") || has("Rounding changed no decision")) CHECK((cut || hit == exact));
        if (has("The decision is the same")) CHECK_FALSE(shown.x.result.is_right());
        if (hit != exact && !cut && !shown.x.result.is_right() && shown.x.result.outcome != Outcome::unresolved) {
            CHECK_FALSE(shown.says("On the inputs as the format stores them, the form"));
            ++seen[starred.empty() ? "turned, nothing named" : "turned, named"];
        }
        if (shown.x.result.is_right()) CHECK((starred.empty() || shown.x.result.lost_bits >= 1));
        const NodeId subject = shown.x.attribution.subject;
        if (subject != no_node && is_decision(shown.x.tape[subject].op)) {
            const std::string name = shown.json["attribution"]["subject"];
            for (const auto& row : shown.json["operations"])
                if (row["name"] == name) CHECK(row["computed"] != row["exact"]);
            ++seen["subject is a decision"];
        }
        seen[starred.empty() ? "no culprit" : "culprit"] += 1;
    });
    CHECK(seen["turned, named"] > 20);
    CHECK(seen["turned, nothing named"] <= seen["turned, named"] / 10);
    CHECK(seen["subject is a decision"] > 20);
    CHECK(seen["culprit"] > 100);
    CHECK(seen["no culprit"] > 100);
}

TEST_CASE("the range of a ray is among the inputs and on the tape, and its decisions agree with the form") {
    int limits = 0, decided = 0, turned = 0;
    on_explained_rays(is_long() ? 40 : 3, 66, [&](const RayQuestion& question, const ShownRay& shown) {
        INFO(shown.text);
        const OneRay::Inputs in = shown.ray.inputs(*question.form, question.format);
        const auto answers = measure::answer::evaluate(*question.form, in.format_inputs);
        REQUIRE(shown.x.hit == (answers.hit[in.index] != 0));
        if (shown.x.hit) REQUIRE(same_number(shown.x.result.t, answers.t[in.index]));
        const bool whole = shown.x.range.is_whole();
        REQUIRE(shown.says("\n  ray.tmin") == !whole);
        REQUIRE(shown.says("\n  ray.tmax") == !whole);
        REQUIRE(shown.json["inputs"].contains("ray.tmin") == !whole);
        REQUIRE(shown.json["open_ends"] == std::string(name_of(shown.x.range.open_ends)));
        limits += !whole;
        if (shown.x.attribution.loop_was_cut_short) return;
        if (const auto exact = exact_decision(question, shown.x)) {
            REQUIRE(shown.x.attribution.is_exact_hit == *exact);
            ++decided;
            turned += shown.x.hit != *exact;
        }
    });
    CHECK(limits > 150);
    CHECK(decided > 150);
    CHECK(turned > 20);
}

TEST_CASE("an explanation never prints an infinity or a NaN as a number") {
    std::map<std::string, int> seen;
    on_explained_rays(is_long() ? 40 : 3, 67, [&](const RayQuestion&, const ShownRay& shown) {
        const output::attribution::OperationView words(shown.x);
        std::vector<std::string> sentences =
            split_lines(shown.verdict.text() + output::attribution::sums_text(shown.x, words));
        sentences.push_back(shown.json["largest_sentence"]);
        for (const std::string& sentence : sentences) {
            INFO(sentence);
            CHECK_FALSE(std::regex_search(sentence, raw_number()));
            seen["infinity"] += sentence.find("infinity") != std::string::npos;
            seen["not a number"] += sentence.find("not a number") != std::string::npos;
            seen["no finite share"] += sentence.find("no finite share") != std::string::npos;
        }
        for (const output::attribution::OperationRow& row : operation_table(shown.x, words, true).rows)
            for (const std::string* const cell :
                 {&row.error_ulps, &row.cancelled, &row.local_bits, &row.rounding_ulps, &row.contribution_ulps})
                CHECK_FALSE(std::regex_search(*cell, raw_number()));
    });
    CHECK(seen["infinity"] > 0);
    CHECK(seen["not a number"] > 0);
}

TEST_CASE("shares, roundings and errors that are not finite are reported as missing") {
    // These may overflow in ways that the tests do not find.
    int said = 0;
    on_explained_rays(1, 69, [&](const RayQuestion&, const ShownRay& shown) {
        if (shown.x.attribution.culprit == no_node) return;
        for (const double odd : {HUGE_VAL, -HUGE_VAL, std::nan("")}) {
            for (int what = 0; what < 4; ++what) {
                Explanation x = shown.x;
                measure::attribution::OperationError& e = x.attribution.errors[x.attribution.culprit];
                if (what == 0) e.contribution = odd;
                if (what == 1) e.contribution = odd, x.attribution.equal_culprits.push_back(x.attribution.culprit);
                if (what == 2) e.rounding = e.error = odd;
                if (what == 3) x.attribution.error = x.attribution.contribution_sum = odd;
                if (x.culprit_alone) x.culprit_alone->only_exact.error = x.culprit_alone->only_rounded.error = odd;
                const output::attribution::OperationView words(x);
                for (const std::string& line : split_lines(output::attribution::culprit_sentence(x) + "\n" +
                                                           make_verdict(x, shown.march).text() + sums_text(x, words))) {
                    INFO(line);
                    CHECK_FALSE(std::regex_search(line, raw_number()));
                    said += line.find("no finite share") != std::string::npos;
                }
            }
        }
    });
    CHECK(said > 100);
}

TEST_CASE("operations marked as not on the way change neither the decision nor t, whatever their value") {
    int changed = 0;
    on_explained_rays(1, 68, [&](const RayQuestion& question, const ShownRay& shown) {
        if (question.format.name == std::string("f64")) return;
        const auto [hit, t, near, far] = shown.x.tape.outputs;
        const output::attribution::OperationView words(shown.x);
        int place = 0;
        for (const output::attribution::OperationRow& row : operation_table(shown.x, words, true).rows) {
            if (!row.is_off_path || shown.x.tape[row.node].op == TapeOp::call || place++ % 7 != 0) continue;
            CHECK(row.contribution_ulps.empty());
            Tape other = shown.x.tape;
            other[row.node] = {.op = TapeOp::input, .format = other[row.node].format, .operands = {0}, .value = 1.5};
            const measure::attribution::Rerun again(other, [](NodeId) { return true; });
            INFO(row.name);
            CHECK((again[hit] != 0) == shown.x.hit);
            if (shown.x.hit) CHECK(same_number(again[t], shown.x.tape[t].value));
            ++changed;
        }
    });
    CHECK(changed > 300);
}

}  // namespace lostbits::test::test_explanations
