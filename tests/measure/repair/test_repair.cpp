// The set of wider operations meets the requirement, is minimal, and is checked on rays that the search did not use.
#include "measure/repair/repair.hpp"

#include <tbb/global_control.h>

#include <algorithm>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/methods.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/repair/price.hpp"
#include "measure/rows.hpp"
#include "number/real.hpp"
#include "output/repair/form_code.hpp"
#include "output/repair/repair_files.hpp"
#include "scene/file/scene.hpp"
#include "scratch.hpp"

namespace lostbits::test::test_mend {

using namespace lostbits::measure::repair;
using scene::file::Scene;
namespace identity = measure::identity;
namespace tape = measure::tape;

namespace {

Scene scene_named(const char* name, int size) { return test::scene_named(name, std::pair{size, size}); }

RepairRequest request_of(const Scene& scene, const char* form, double bits) {
    RepairRequest request{.scene = &scene, .tested_form = test::row(form, "f32")};
    request.requirement = {.bits = bits, .max_wrong_fraction = 0, .quantile = 1};
    return request;
}

/// The operations that must be wider, without the rewriting that `repair_form` tries too.
struct Search {
    explicit Search(const RepairRequest& repair_request)
        : request(repair_request), measurer(repair_request), tape(record_tape(repair_request)) {}
    FormQuality with(const std::vector<NodeId>& wider) {
        return measurer.measure_quality({tape::widen_operations(tape, wider, binary64)}).front();
    }
    WiderSet smallest(std::uint64_t max_sets_per_size) {
        const FormQuality quality = with(all);
        REQUIRE(quality.meets(request.requirement));
        return find_smallest_set(tape, binary64, quality, request, measurer, max_sets_per_size);
    }
    const RepairRequest& request;
    QualityMeasurer measurer;
    Tape tape;
    std::vector<NodeId> all = tape::find_widenable_operations(tape);
};

bool same(const FormQuality& a, const FormQuality& b) {
    return a.wrong_count == b.wrong_count && a.true_hit_count == b.true_hit_count && a.ray_count == b.ray_count &&
           (a.kept_bits == b.kept_bits || (std::isnan(a.kept_bits) && std::isnan(b.kept_bits)));
}

}  // namespace

TEST_CASE("measured again, the set meets the requirement, and fails it without any one of its operations", "[mend]") {
    for (const auto& [name, form, bits] :
         {std::tuple("rtg-fig-7-3-4100-oblique", "sphere.half_b", 16.0),
          std::tuple("near-benign", "sphere.schoolbook", 20.0), std::tuple("cylinder-far", "cylinder.crossed", 12.0),
          std::tuple("triangle-far", "triangle.undivided", 12.0), std::tuple("box-slabs", "box.baseline", 10.0)}) {
        INFO(name << ", " << form);
        const Scene scene = scene_named(name, is_long() ? 40 : 24);
        const RepairRequest request = request_of(scene, form, bits);
        Search search(request);
        CHECK_FALSE(search.with({}).meets(request.requirement));
        const WiderSet found = search.smallest(200);
        QualityMeasurer measurer(request, scene);
        const auto quality_with = [&](const std::vector<NodeId>& wider) {
            return measurer.measure_quality({tape::widen_operations(search.tape, wider, binary64)}).front();
        };
        const auto& set = found.operations;
        REQUIRE_FALSE(set.empty());
        CHECK(set.size() < search.all.size());
        CHECK(found.quality.meets(request.requirement));
        CHECK(same(quality_with(set), found.quality));
        REQUIRE(found.quality_without.size() == set.size());
        for (std::size_t k = 0; k < set.size(); ++k) {
            std::vector<NodeId> fewer = set;
            fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
            const FormQuality there = quality_with(fewer);
            CHECK(same(there, found.quality_without[k]));
            CHECK_FALSE(there.meets(request.requirement));
        }
        if (scene.id != "box-slabs") continue;
        // Three operations are needed: all sets of two were tried, and none of them is enough.
        REQUIRE(set.size() == 3);
        CHECK(found.largest_failing_size == 2);
        std::vector<Tape> pairs;
        for (const NodeId a : search.all)
            for (const NodeId b : search.all)
                if (a <= b) pairs.push_back(tape::widen_operations(search.tape, {a, b}, binary64));
        for (const FormQuality& quality : measurer.measure_quality(pairs))
            CHECK_FALSE(quality.meets(request.requirement));
    }
}

// No rule closes the cracks of a far mesh: both triangles of an edge share cross products of vectors from the ray's
// origin, and if these vectors are long and nearly equal, little is left of the products.
TEST_CASE("edges seen from the ray's origin decide better near a triangle, and far from a mesh much worse", "[mend]") {
    for (const auto& [name, size, is_far] :
         {std::tuple("triangle-edge", 64, false), std::tuple("mesh-icosphere-edges", 24, true)}) {
        INFO(name);
        const Scene scene = scene_named(name, size);
        const RepairRequest request = request_of(scene, "triangle.undivided", 10);
        const Tape before = tape::record_tape(*request.tested_form.form, request.tested_form.format);
        identity::Terms terms(before);
        std::vector<Tape> tapes{before};
        for (const auto& rewrite : identity::find_rewrites(terms, terms.outputs(), std::nullopt))
            if (rewrite.rule->name == "edges from the origin")
                tapes.push_back(terms.tape(terms.replace_nodes(terms.outputs(), rewrite.replacements)));
        REQUIRE(tapes.size() == 2);
        tapes.push_back(tape::record_tape(test::form_named("triangle.signed_volumes"), *find_format("f32")));
        QualityMeasurer measurer(request, scene);
        const auto quality = measurer.measure_quality(tapes);
        if (is_far) {
            CHECK(quality[1].wrong_count > 10 * quality[0].wrong_count);
            CHECK(quality[2].wrong_count > 10 * quality[0].wrong_count);
        } else {
            CHECK(quality[1].wrong_count < quality[0].wrong_count);
        }
    }
}

TEST_CASE("a form that meets the requirement has an empty set, and one that double does not help has none", "[mend]") {
    const Scene scene = scene_named("near-benign", 32);
    const RepairRequest easy = request_of(scene, "sphere.half_b", 5);
    const RepairResult enough = repair_form(easy);
    REQUIRE(enough.wider_set);
    CHECK(enough.wider_set->operations.empty());
    // Its contract is a direction of length one, which a rounded direction is not.
    const Scene far = scene_named("rtg-fig-7-3-4100-oblique", 32);
    const RepairRequest hard = request_of(far, "sphere.pythagoras", 16);
    const RepairResult none = repair_form(hard);
    CHECK_FALSE(none.wider_set);
    const std::string words =
        output::repair::repair_text({.request = hard, .repair = none, .catalogue = {}, .catalogue_quality = {}});
    CHECK_THAT(words, Catch::Contains("does not meet the requirement"));
    CHECK_THAT(words, Catch::Contains("assumes directions of length one"));
    // No precision helps, but directions of length one do.
    REQUIRE(none.obstruction);
    CHECK_FALSE(none.obstruction->exact.meets(hard.requirement));
    REQUIRE(none.obstruction->with_unit_directions);
    CHECK(none.obstruction->with_unit_directions->wrong_count < none.obstruction->exact.wrong_count);
    CHECK(none.obstruction->largest_length_error > 0);
    CHECK(none.obstruction->largest_length_error < 0x1p-22);
}

TEST_CASE("the matrix of each probe times its transpose is the square of the divisor", "[mend]") {
    for (const Isometry& by : isometries) {
        INFO(by.name);
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                int sum = 0;
                for (std::size_t l = 0; l < 3; ++l) sum += by.entries[3 * i + l] * by.entries[3 * k + l];
                CHECK(sum == (i == k ? by.divisor * by.divisor : 0));
            }
    }
    const Scene scene = scene_named("box-slabs", 16);
    const auto box = scene.listed.front();
    CHECK_FALSE(map_primitive(box, isometries[5]).has_value());
    const auto mirrored = map_primitive(box, isometries[3]).value().box();
    CHECK(mirrored.lo.y == -box.box().hi.y);
    CHECK(mirrored.hi.z == -box.box().lo.z);
}

TEST_CASE("operations that exchanged axes map to one another are in one group", "[mend]") {
    const auto groups_of = [](const char* form, const Primitive<double>& like) {
        const Tape tape = tape::record_tape(test::form_named(form), *find_format("f32"));
        const auto all = tape::find_widenable_operations(tape);
        const auto groups = find_exchanged_groups(tape, all, like);
        std::size_t members = 0;
        for (const auto& group : groups) members += group.size();
        CHECK(members == all.size());
        return groups;
    };
    // 1/d, lo - o, hi - o, and the two products.
    const auto of_box = groups_of("box.baseline", Primitive<double>(Shape::box));
    CHECK(of_box.size() == 5);
    for (const auto& group : of_box) CHECK(group.size() == 3);
    // A dot product is one group of products and one of sums.
    const auto of_sphere = groups_of("sphere.half_b", Primitive<double>(Shape::sphere));
    CHECK(std::ranges::count(of_sphere, std::size_t{3}, &std::vector<NodeId>::size) >= 4);
}

TEST_CASE("exchanged axes group the operations of forms with transforms, stored either way", "[mend]") {
    Primitive<double> like(Shape::sphere);
    for (const bool inverse : {false, true}) {
        CAPTURE(inverse);
        like.transform = Transform<double>{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, inverse, 1};
        const auto& form = intersect::transform::transformed_form(test::transform_method_named("plain"),
                                                                  test::form_named("sphere.half_b"));
        const Tape tape = tape::record_tape(form, *find_format("f32"), inverse);
        std::vector<NodeId> members;
        std::size_t of_three = 0;
        for (const auto& group : find_exchanged_groups(tape, tape::find_widenable_operations(tape), like)) {
            members.insert(members.end(), group.begin(), group.end());
            of_three += group.size() % 3 == 0;
        }
        std::ranges::sort(members);
        CHECK(members == tape::find_widenable_operations(tape));
        // A stored matrix is inverted by a determinant along its first row, which no exchange keeps.
        if (inverse) CHECK(of_three >= 6);
    }
}

TEST_CASE("a set that helps one axis is made symmetric in double too, and with inputs of each format", "[mend]") {
    for (const auto& [format, inputs, bits] : {std::tuple("f32", scene::file::InputRounding::own, 20.0),
                                               std::tuple("f64", scene::file::InputRounding::shared, 49.0)}) {
        CAPTURE(format, bits);
        Scene scene = scene_named("box-slabs", 24);
        scene.inputs = inputs;
        RepairRequest request = request_of(scene, "box.baseline", bits);
        request.tested_form = test::row("box.baseline", format);
        const RepairResult m = repair_form(request, 1);
        REQUIRE(m.wider_set);
        CHECK(m.wider_set->quality.meets(request.requirement));
        CHECK(m.set_probe_qualities.size() == m.probes.size());
        const bool holds = std::ranges::all_of(
            m.set_probe_qualities, [&](const FormQuality& quality) { return quality.meets(request.requirement); });
        CHECK(holds == !m.symmetric);
        if (!m.symmetric) continue;
        CHECK(m.symmetric->operations.size() % 3 == 0);
        CHECK(m.symmetric->quality.meets(request.requirement));
        for (const FormQuality& quality : m.symmetric->probe_qualities) CHECK(quality.meets(request.requirement));
    }
}

TEST_CASE("a set that helps one axis is measured on others, and made symmetric", "[mend]") {
    const Scene scene = scene_named("box-slabs", 48);
    const RepairRequest request = request_of(scene, "box.baseline", 20);
    const RepairResult m = repair_form(request);
    REQUIRE(m.wider_set);
    CHECK(m.wider_set->operations.size() == 3);
    REQUIRE(m.probes.size() == 5);  // a box is not rotated
    const auto meets = [&](const FormQuality& quality) { return quality.meets(request.requirement); };
    for (std::size_t k = 0; k < 3; ++k) CHECK_FALSE(meets(m.set_probe_qualities[k]));
    REQUIRE(m.symmetric);
    CHECK(m.symmetric->is_smallest);
    CHECK(m.symmetric->operations.size() % 3 == 0);
    CHECK(meets(m.symmetric->quality));
    for (const FormQuality& quality : m.symmetric->probe_qualities) CHECK(meets(quality));
    const output::repair::RepairSummary result{
        .request = request, .repair = m, .catalogue = {}, .catalogue_quality = {}};
    const auto proposals = list_proposals(result);
    CHECK_FALSE(proposals.front().meets_on_exact_probes(result));
    REQUIRE(best_proposal(proposals, result) != nullptr);
    CHECK(best_proposal(proposals, result)->is_symmetric_set);
    CHECK(probe_rows(result).size() == m.probes.size() * (3 + m.rewriting.forms.size()));
}

TEST_CASE("pairs of floats have the same effect as double here", "[mend]") {
    const Scene scene = scene_named("rtg-fig-7-3-4100-oblique", 16);
    RepairRequest request = request_of(scene, "sphere.half_b", 16);
    request.two_words = true;
    const RepairResult m = repair_form(request, 1);
    CHECK(m.wider == tape::two_floats);
    CHECK(m.all_wider_quality.kept_bits > 23);
    CHECK((m.held_out_scene.width != scene.width && m.set_held_out_quality.ray_count != m.own_quality.ray_count));
    CHECK(m.wider_set.value().quality.meets(request.requirement));
}

TEST_CASE("with transforms the operations that lead into the space of the primitive are made wider", "[mend]") {
    Scene scene = scene_named("instance-far.sphere", 16);
    for (const bool inverse : {false, true}) {
        CAPTURE(inverse);
        if (inverse) {
            // The rotated sphere as the matrix back to it: the file holds the transpose, and -A^T T.
            auto& transform = *scene.listed.front().transform;
            const auto there = transform.map();
            const Affine<Real> back{{Vec<Real>(there.rows[0].x, there.rows[1].x, there.rows[2].x),
                                     Vec<Real>(there.rows[0].y, there.rows[1].y, there.rows[2].y),
                                     Vec<Real>(there.rows[0].z, there.rows[1].z, there.rows[2].z)},
                                    {Real(0), Real(0), Real(0)}};
            const Vec<Real> shift = back.linear(there.shift);
            std::size_t k = 0;
            Affine<Real>{back.rows, {-shift.x, -shift.y, -shift.z}}.for_each_number(
                [&](const Real& x) { transform.matrix[k++] = x; });
            transform.is_inverse = true;
        }
        RepairRequest request = request_of(scene, "sphere.unified", 18);
        const auto& form = *request.tested_form.form;
        request.tested_form.form = &intersect::transform::transformed_form(test::transform_method_named("plain"), form);
        Search search(request);
        const FormQuality own = search.with({});
        CHECK(own.kept_bits < 14);
        CHECK(search.smallest(0).quality.meets(request.requirement));
        CHECK(search.all.size() >
              tape::find_widenable_operations(tape::record_tape(form, request.tested_form.format)).size());
        request.tested_form.form =
            &intersect::transform::transformed_form(test::transform_method_named("relative"), form);
        const FormQuality relative = QualityMeasurer(request, scene).measure_quality({record_tape(request)}).front();
        CHECK(relative.kept_bits > own.kept_bits + (inverse ? -1 : 6));
    }
    scene.listed.push_back(scene.listed.front());
    scene.listed.back().transform.reset();
    RepairRequest mixed = request_of(scene, "sphere.unified", 18);
    mixed.tested_form.form = &intersect::transform::transformed_form(intersect::transform::default_transform_method(),
                                                                     *mixed.tested_form.form);
    CHECK_THROWS_AS(repair_form(mixed, 0), InputError);
}

TEST_CASE("a form that decides by itself how many steps it computes is refused", "[mend]") {
    const Scene scene = scene_named("rtg-fig-7-3-4100-oblique", 32);
    const RepairRequest request = request_of(scene, "sphere.filtered", 16);
    CHECK_THROWS_WITH(repair_form(request), Catch::Contains("uses more precision where a ray needs it"));
}

TEST_CASE("a form that cannot be compiled has no cost, and the message says why", "[mend]") {
    const Scene scene = scene_named("near-benign", 8);
    const RepairRequest request = request_of(scene, "sphere.half_b", 5);
    const Tape tape = tape::record_tape(*request.tested_form.form, request.tested_form.format);
    const std::vector<RepairedSource> forms{
        {.tape = &tape, .header = "", .type = "None", .original = request.tested_form}};
    const test::Scratch folder;
    CHECK_THROWS_WITH(compile_and_load(request, forms, {"c++", folder.path()}), Catch::Contains("form.flags"));
    folder.write("form.flags", "");
    CHECK_THROWS_WITH(compile_and_load(request, forms, {"no-such-compiler", folder.path()}),
                      Catch::Contains("no-such-compiler"));
}

TEST_CASE("only wider operations, and operations that use their results, change in the code", "[mend]") {
    const auto& form = test::form_named("sphere.half_b");
    const Tape tape = tape::record_tape(form, *find_format("f32"));
    const auto before = output::repair::statements(tape, form);
    CHECK(output::repair::changed_lines(before, before).empty());
    const auto named = std::ranges::find(tape.nodes, std::string_view("disc"), &TapeNode::label);
    REQUIRE(named != tape.nodes.end());
    const auto disc = static_cast<NodeId>(named - tape.nodes.begin());
    const auto after = output::repair::statements(tape::widen_operations(tape, {disc}, binary64), form);
    CHECK(after.size() == before.size());
    const auto lines = output::repair::changed_lines(before, after);
    REQUIRE(lines.size() == 6);
    CHECK(lines[0] == "- const T disc = named(\"disc\", square(h) - a*c);");
    CHECK(lines[1] == "+ const W disc = named(\"disc\", wide(square(h)) - wide(a*c));");
    CHECK(lines[3].find("sqrt(narrow(disc))") != std::string::npos);
    CHECK(lines[5].find("(disc < W(0))") != std::string::npos);
}

}  // namespace lostbits::test::test_mend
