// Named cases: verdicts worked out by hand, improper rays, and the files under data/sweeps/extremes.
#include "measure/sweep/sweep.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "number/real.hpp"

namespace test_cases {

using namespace lostbits;
using namespace lostbits::test;
using measure::answer::Outcome;
using measure::evaluate::FormSummary;
using measure::sweep::Verdict;

namespace {

const std::string head = "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n";

std::string one_case(const std::string& name, const std::string& sphere, const std::string& rays) {
    return "[[case]]\nname = \"" + name + "\"\nspheres = [{ " + sphere + " }]\nrays = [" + rays + "]\n";
}

/// The schoolbook form computes a = d·d, b = 2 f·d, c = f·f − r², disc = b² − 4ac, t = (−b ± √disc)/2a; all of it in
/// binary32.
const std::string by_hand =
    // b² − 4ac = 100 − 84 and t = 3: every number is exact.
    one_case("exact", "centre = [0, 0, 5], radius = 2", "{ origin = [0, 0, 0], direction = [0, 0, 1] }") +
    // f·f = 4097² = 16785409 ties to 16785408, and minus 1 again; b² = 67141636 ties to 67141632 = 4ac. So disc = 0 and
    // t = 4097 for 4096: 2^11 ulps of 2^-11 each, 12 bits.
    one_case("radius lost", "centre = [0, 0, 4097], radius = 1", "{ origin = [0, 0, 0], direction = [0, 0, 1] }") +
    // f·f = 2^132 overflows, b² = 2^114 does not: disc = −inf.
    one_case("c overflows", "centre = [0, 0, '0x1p66'], radius = '0x1p60'",
             "{ origin = [0, 0, 0], direction = [0, 0, '0x1p-10'] }") +
    // f·f and r² underflow, c = 0, so every line touches; this one passes at four radii.
    one_case("c underflows", "centre = ['0x1p-98', 0, '0x1p-98'], radius = '0x1p-100'",
             "{ origin = [0, 0, 0], direction = [0, 0, 1] }") +
    // a = 2^200 and b² overflow: disc = inf − inf.
    one_case("a overflows", "centre = [0, 0, 5], radius = 2", "{ origin = [0, 0, 0], direction = [0, 0, '0x1p100'] }") +
    // a = d·d = 2^-200 vanishes: t = −b/0 is infinite, and all 24 bits of 3·2^100 are gone.
    one_case("a underflows", "centre = [0, 0, 5], radius = 2",
             "{ origin = [0, 0, 0], direction = [0, 0, '0x1p-100'] }") +
    // The same, but t = 3/tiny is infinite when it is rounded, too.
    one_case("t overflows", "centre = [0, 0, 5], radius = 2", "{ origin = [0, 0, 0], direction = [0, 0, 'tiny'] }") +
    // A miss is a miss: disc = 100 − 4·(9 + 25 − 4) = −20.
    one_case("exact miss", "centre = [3, 0, 5], radius = 2", "{ origin = [0, 0, 0], direction = [0, 0, 1] }");

FormSummary summary_of(std::initializer_list<std::pair<Outcome, std::uint64_t>> counts, double excess) {
    FormSummary s;
    for (const auto& [outcome, n] : counts) {
        s.outcomes[static_cast<std::size_t>(outcome)] = n;
        s.ray_count += n;
    }
    s.metrics = std::vector<measure::metric::Distribution>(2);
    if (!std::isnan(excess)) s.metrics[1].add(excess);
    for (measure::metric::Distribution& d : s.metrics) d.seal();
    return s;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

TEST_CASE("verdicts agree with those worked out by hand") {
    const TextFile text(head + by_hand);
    const scene::sweep::CaseFile file(text.path());
    const measure::sweep::CaseRequest request{
        .file = file,
        .tested_forms = {row("sphere.schoolbook", "f32"), row("sphere.schoolbook", "f64")},
        .metrics = case_metrics};
    const auto cases = measure::sweep::run_cases(request);
    REQUIRE(cases.size() == file.size());
    struct Expected {
        const char* name;
        Verdict in_f32;
        double bits;  ///< lost in f32
        Verdict in_f64;
    };
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    // In f64 the same lengths are ordinary, but the smallest number is 2^-1074 there, and t = 3·2^1074 is infinite as
    // well.
    const Expected expected[] = {{"exact", Verdict::right, 0, Verdict::right},
                                 {"radius lost", Verdict::wrong_value, 12, Verdict::right},
                                 {"c overflows", Verdict::false_miss, none, Verdict::right},
                                 {"c underflows", Verdict::false_hit, none, Verdict::right},
                                 {"a overflows", Verdict::not_a_number, none, Verdict::right},
                                 {"a underflows", Verdict::wrong_value, 24, Verdict::right},
                                 {"t overflows", Verdict::right, 0, Verdict::right},
                                 {"exact miss", Verdict::right, none, Verdict::right}};
    for (std::size_t i = 0; i < file.size(); ++i) {
        CAPTURE(expected[i].name);
        CHECK(file.name(i) == expected[i].name);
        CHECK(measure::sweep::verdict_of(cases[i][0], request.metrics, 3) == expected[i].in_f32);
        CHECK(same(cases[i][0].metrics[0].quantile(1), expected[i].bits));
        CHECK(measure::sweep::verdict_of(cases[i][1], request.metrics, 3) == expected[i].in_f64);
        CHECK(cases[i][0].ray_count == 1);
        // One row of one case is the same as this row among all rows.
        const FormSummary alone = measure::sweep::run_cases_together(request, 0, {i});
        CHECK(alone.outcomes == cases[i][0].outcomes);
        CHECK(same(alone.metrics[0].quantile(1), cases[i][0].metrics[0].quantile(1)));
    }
    CHECK(cases[1][0].worst.t == 4097);
    CHECK(cases[1][0].worst.size == 2048);
    CHECK(std::isinf(cases[5][0].worst.t));
    // Far enough from the envelope to be wrong for every limit below the loss. For a limit above it, the inputs allow
    // no better until the limit is as large as the loss itself.
    const double excess = cases[1][0].metrics[1].quantile(1);
    CHECK(excess > 8);
    CHECK(excess < 12);
    // All but `excess` of the 12 bits are due to the inputs: the answer is not wrong, and not right either.
    CHECK(measure::sweep::verdict_of(cases[1][0], request.metrics, excess) == Verdict::within_inputs);
    CHECK(measure::sweep::verdict_of(cases[1][0], request.metrics, 12) == Verdict::right);
    CHECK(measure::sweep::verdict_of(cases[1][0], request.metrics, std::nextafter(excess, 0)) == Verdict::wrong_value);
}

TEST_CASE("wrong decisions rank before wrong values, and the most frequent of them counts") {
    using O = Outcome;
    const auto verdict = [](std::initializer_list<std::pair<O, std::uint64_t>> counts, double excess) {
        return measure::sweep::verdict_of(summary_of(counts, excess), case_metrics, 3);
    };
    constexpr double none = std::numeric_limits<double>::quiet_NaN(),
                     infinity = std::numeric_limits<double>::infinity();
    CHECK(verdict({{O::agree_hit, 5}}, 3) == Verdict::right);
    CHECK(verdict({{O::agree_hit, 5}}, 3.01) == Verdict::wrong_value);
    CHECK(verdict({{O::agree_hit, 5}}, infinity) == Verdict::wrong_value);
    CHECK(verdict({{O::agree_miss, 5}}, none) == Verdict::right);
    CHECK(verdict({{O::agree_hit, 5}, {O::false_hit, 1}}, 24) == Verdict::false_hit);
    CHECK(verdict({{O::agree_hit, 500}, {O::false_miss, 1}}, 0) == Verdict::false_miss);
    CHECK(verdict({{O::false_hit, 3}, {O::false_miss, 2}, {O::not_a_number, 1}}, 24) == Verdict::false_hit);
    CHECK(verdict({{O::false_hit, 1}, {O::false_miss, 2}, {O::not_a_number, 1}}, 24) == Verdict::false_miss);
    CHECK(verdict({{O::false_hit, 1}, {O::false_miss, 2}, {O::not_a_number, 3}}, 24) == Verdict::not_a_number);
    CHECK(verdict({{O::agree_hit, 9}, {O::false_hit, 9}, {O::unresolved, 1}}, 0) == Verdict::unresolved);
}

TEST_CASE("an improper ray or primitive is never a hit") {
    const Ray<double> ray{{0, 0, -8}, {0, 0, 1}};
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    CHECK(measure::truth::is_valid(ray));
    CHECK(measure::truth::is_valid(Ray<double>{{0, 0, 0}, {0, 0, -0x1p-1074}}));
    CHECK_FALSE(measure::truth::is_valid(Ray<double>{{0, 0, 0}, {0, -0.0, 0}}));
    CHECK_FALSE(measure::truth::is_valid(Ray<double>{{0, nan, 0}, {0, 1, 0}}));
    CHECK_FALSE(measure::truth::is_valid(Ray<double>{{0, 0, 0}, {infinity, 1, 0}}));
    CHECK_FALSE(measure::truth::is_valid(Ray<Real>{{Real(0), Real(0), Real(0)}, {Real(0), Real(0), Real(0)}}));
    CHECK(measure::truth::is_valid(
        Ray<Real>{{Real(0), Real(0), Real(0)}, {Real(0), Real(0), Real(ldexp(Real(1), -5000))}}));
    const Primitive<double> good = Sphere<double>{{0, 0, 0}, 2};
    CHECK(measure::truth::find_truth(ray, good).is_hit());
    for (const double radius : {0.0, -2.0, nan, infinity}) {
        const Primitive<double> bad = Sphere<double>{{0, 0, 0}, radius};
        CHECK_FALSE(measure::truth::is_valid(bad));
        CHECK(measure::truth::find_truth(ray, bad).decision == measure::truth::Truth::Decision::miss);
        // It does not hide the primitive beside it, and is not named.
        const std::vector<Primitive<double>> both{bad, good};
        CHECK(measure::truth::find_truth(ray, both).is_hit());
        CHECK(measure::truth::find_truth(ray, both).primitive == 1);
    }
    CHECK_FALSE(measure::truth::is_valid(Primitive<double>(Sphere<double>{{nan, 0, 0}, 2})));
    CHECK(measure::truth::is_valid(Primitive<double>(Box<double>{{0, 0, 0}, {0, 1, 1}})));
    CHECK_FALSE(measure::truth::is_valid(Primitive<double>(Box<double>{{0, 0, 0}, {-1, 1, 1}})));
    CHECK_FALSE(measure::truth::is_valid(Primitive<double>(Box<double>{{0, 0, 0}, {1, nan, 1}})));
    CHECK(measure::truth::find_truth(ray, Primitive<double>(Box<double>{{-1, -1, 1}, {1, 1, -1}})).decision ==
          measure::truth::Truth::Decision::miss);
}

TEST_CASE("every file of extremes runs with every form and has a proved truth") {
    const auto folder = std::filesystem::path(LOSTBITS_DATA_DIR) / "sweeps/extremes";
    int files = 0;
    std::uint64_t invented = 0;  // by forms without a guard
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        ++files;
        const scene::sweep::CaseFile file(entry.path());
        CAPTURE(file.id);
        CHECK_FALSE(file.title.empty());
        CHECK_FALSE(file.note.empty());
        const measure::sweep::CaseRequest request{
            .file = file,
            .tested_forms = all_rows(file.shapes().front(), {"f32", "f64", "bf16"}),
            .metrics = case_metrics};
        const auto cases = measure::sweep::run_cases(request);
        REQUIRE(cases.size() == file.size());
        for (std::size_t i = 0; i < cases.size(); ++i) {
            CAPTURE(file.name(i));
            REQUIRE(cases[i].size() == request.tested_forms.size());
            bool any_right = false;
            for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
                CAPTURE(request.tested_forms[r].form->info->name, request.tested_forms[r].format.name);
                const FormSummary& s = cases[i][r];
                const Verdict v = measure::sweep::verdict_of(s, request.metrics, file.right_within_bits);
                CHECK(v != Verdict::unresolved);
                any_right |= v == Verdict::right || v == Verdict::within_inputs;
                CHECK(s.ray_count > 0);
                CHECK(std::accumulate(s.outcomes.begin(), s.outcomes.end(), std::uint64_t{0}) == s.ray_count);
                if (file.id != "not-numbers") continue;
                CHECK(s.true_hit_count == 0);
                CHECK(s.count(Outcome::agree_miss) + s.count(Outcome::false_hit) + s.count(Outcome::not_a_number) ==
                      s.ray_count);
                invented += s.count(Outcome::false_hit);
            }
            if (file.accepts(Shape::sphere) && file.id != "scale") CHECK(any_right);
        }
    }
    CHECK(files >= 4);
    CHECK(invented > 0);
}

}  // namespace test_cases
