// Every float across a mesh, compared with its triangles tested one by one.
#include <algorithm>
#include <map>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "measure/sweep/exhaustive.hpp"
#include "number/error.hpp"
#include "scratch.hpp"

namespace test_mesh_floats {

using namespace lostbits;
using namespace lostbits::test;
using measure::answer::Outcome;
using scene::sweep::ExhaustiveFile;
namespace sweep = measure::sweep;

namespace {

std::string sweep_text(const std::string& axis, const std::string& origin = "-8, -4, 1024") {
    return "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\nscene = \"mesh-icosphere-near\"\n"
           "[axis]\nname = \"x\"\nspacing = \"every_float\"\n" +
           axis + "\n[[ray]]\nname = \"far\"\norigin = [" + origin + "]\ndirection = [\"0x1p-7\", \"0x1p-8\", -1]\n";
}

/// Number of triangles that the form claims, and number of different t at which the ray truly crosses triangles.
struct Counted {
    std::size_t claimed = 0, crossed = 0;
};

Counted count_at(const ExhaustiveFile& file, const measure::evaluate::TestedForm& row, float value) {
    const Ray<double> ray = file.group_at(0, value).rays[0];
    Counted counted;
    std::vector<measure::truth::CertifiedNumber> apart;
    for (std::size_t s = 0; s < file.mesh->size(); ++s) {
        const Primitive<double> triangle = (*file.mesh)[s];
        counted.claimed += evaluate_alone(row, ray, triangle).has_value();
        const auto truth = measure::truth::find_truth(ray, triangle, {}, row.convention());
        const auto same = [&](const measure::truth::CertifiedNumber& other) { return compare(other, truth.t) == 0; };
        if (truth.is_hit() && std::ranges::none_of(apart, same)) apart.push_back(truth.t);
    }
    counted.crossed = apart.size();
    return counted;
}

/// Compares every form's counts at 1025 floats with its triangles tested one by one; returns the counts of each form.
std::vector<sweep::FloatTally> check_counts(const ExhaustiveFile& file) {
    REQUIRE(file.float_count() == 1025);
    sweep::ExhaustiveRequest request{.sweep = file};
    for (const char* form : {"triangle.undivided", "triangle.havel_herout", "triangle.woop", "triangle.filtered"})
        request.tested_forms.push_back(row(form, "f32"));
    sweep::ExhaustiveState state;
    sweep::run_exhaustive(request, state);
    std::vector<sweep::FloatTally> all;
    for (const sweep::RangeFinding& finding : sweep::collect_findings(request, state)) {
        const sweep::FloatTally& tally = finding.tally;
        CAPTURE(request.tested_forms[finding.row].form->info->name);
        CHECK(tally.float_count() == 1025);
        std::uint64_t odd = 0;
        std::map<Outcome, std::uint64_t> counts;
        for (std::uint64_t i = 0; i < finding.floats.size(); ++i) {
            const std::uint32_t place = finding.floats.at(i);
            const auto counted = count_at(file, request.tested_forms[finding.row], scene::sweep::float_at(place));
            const auto answer = sweep::answer_at(request, 0, finding.row, place);
            ++counts[answer.outcome];
            const bool is_odd = counted.claimed % 2 != counted.crossed % 2;
            odd += is_odd;
            if (answer.outcome == Outcome::crack) CHECK(is_odd);
            if (answer.outcome == Outcome::double_hit) CHECK(counted.claimed > 1);
        }
        for (std::size_t o = 0; o < tally.outcomes.size(); ++o)
            CHECK(tally.outcomes[o] == counts[static_cast<Outcome>(o)]);
        CHECK(tally.count(Outcome::crack) <= odd);
        CHECK(tally.wrong_count() == counts[Outcome::crack] + counts[Outcome::double_hit] +
                                         counts[Outcome::false_miss] + counts[Outcome::false_hit] +
                                         counts[Outcome::wrong_primitive]);
        all.push_back(tally);
    }
    return all;
}

}  // namespace

TEST_CASE("every float of a sweep through a mesh vertex is counted as by its triangles one by one",
          "[exhaustive][mesh]") {
    const Scratch folder;
    const ExhaustiveFile file(
        folder.write("s.toml", sweep_text("set = \"ray.origin.x\"\nfrom = -7.992431640625\nto = -7.991943359375",
                                          "-8, -3.99609375, 1024")),
        LOSTBITS_DATA_DIR);
    const Ray<double> through = file.group_at(0, -7.9921875F).rays[0];
    std::size_t at_vertex = 0;
    for (std::size_t s = 0; s < file.mesh->size(); ++s) {
        const auto truth = measure::truth::find_truth(through, (*file.mesh)[s]);
        at_vertex += truth.touches && compare(truth.t, measure::truth::as_certified(1023)) == 0;
    }
    CHECK(at_vertex == 6);
    const auto tallies = check_counts(file);
    CHECK(tallies.front().count(Outcome::crack) > 0);
    // All six closed triangles meet the vertex. Only there does a form that decides correctly hit twice.
    const sweep::FloatTally& filtered = tallies.back();
    CHECK(filtered.wrong_count() == 1);
    CHECK(filtered.count(Outcome::double_hit) == 1);
    CHECK(scene::sweep::float_at(filtered.first_wrong->float_index) == -7.9921875F);
}

TEST_CASE("a sweep across a mesh moves numbers of the ray over a range", "[exhaustive][mesh]") {
    const Scratch folder;
    const auto refuses = [&](const std::string& axis, const std::string& why) {
        try {
            const ExhaustiveFile unused(folder.write("s.toml", sweep_text(axis)), LOSTBITS_DATA_DIR);
            FAIL("accepted: " << axis);
        } catch (const InputError& error) {
            INFO(error.what());
            CHECK(std::string(error.what()).find(why) != std::string::npos);
        }
    };
    refuses("set = \"ray.origin.x\"\nall = true", "write from and to");
    refuses("set = \"triangle.a.x\"\nfrom = 1\nto = 2", "the numbers of a mesh are fixed");
}

}  // namespace test_mesh_floats
