// A program over columns has the bits of the form from which its tape was recorded, and of the tape run node by node.
#include "measure/tape/tape_program.hpp"

#include <cmath>

#include "catch.hpp"
#include "intersect/bounding_box/behind.hpp"
#include "intersect/transform/transform_method.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/attribution/operations.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "measure/rows.hpp"
#include "measure/tape/tape_form.hpp"
#include "number/oracle.hpp"

namespace lostbits::test::test_tape_program {

using namespace lostbits::measure::tape;
using intersect::table::Intersector;

namespace {

bool same_answer(const Hit<double>& a, const Hit<double>& b) {
    return a.hit == b.hit && same_number(a.t, b.t) && same_number(a.near, b.near) && same_number(a.far, b.far);
}

/// Rays of a form: one block and some more.
std::vector<Setting> draw(const Intersector& form, const Format& format) {
    Random random(41);
    std::vector<Setting> all;
    for (int i = 0; i < 150; ++i) all.push_back(draw_setting(random, form, format, i % 3 == 0 ? 1000 : 2));
    return all;
}

/// One call over all rays, each with its own primitive.
template <class S>
std::vector<Hit<double>> in_columns(const TapeProgram& program, const std::vector<Setting>& settings) {
    const std::size_t n = settings.size();
    std::array<std::vector<S>, 9> x;
    for (auto& column : x) column.resize(n);
    std::vector<std::uint8_t> hit(n);
    std::vector<Primitive<S>> primitives;
    for (std::size_t i = 0; i < n; ++i) {
        for (int k = 0; k < 3; ++k) {
            x[k][i] = static_cast<S>(settings[i].ray.origin[k]);
            x[3 + k][i] = static_cast<S>(settings[i].ray.direction[k]);
        }
        primitives.push_back(
            convert_numbers(settings[i].primitives.front(), [](double v) { return static_cast<S>(v); }));
    }
    program.run<S>({x[0], x[1], x[2], x[3], x[4], x[5]},
                   intersect::Target<S>(std::span<const Primitive<S>>(primitives)), {x[6], x[7], x[8], hit});
    std::vector<Hit<double>> all;
    for (std::size_t i = 0; i < n; ++i) all.push_back({hit[i] != 0, x[6][i], x[7][i], x[8][i]});
    return all;
}

std::vector<Hit<double>> in_columns(const Format& format, const TapeProgram& program,
                                    const std::vector<Setting>& rays) {
    return format.engine == Format::Engine::native32 ? in_columns<float>(program, rays)
                                                     : in_columns<double>(program, rays);
}

/// A tape of float and double node by node, by the rounding that the emulated formats use.
Hit<double> node_by_node(const Tape& tape, const Setting& setting) {
    namespace attribution = measure::attribution;
    std::vector<double> inputs{setting.ray.origin.x,    setting.ray.origin.y,    setting.ray.origin.z,
                               setting.ray.direction.x, setting.ray.direction.y, setting.ray.direction.z};
    for (const double x : setting.primitives.front().shape_numbers()) inputs.push_back(x);
    inputs.push_back(HUGE_VAL);
    std::vector<double> value(tape.nodes.size());
    struct Judge {
        const std::vector<double>& value;
        const TapeNode& n;
        [[nodiscard]] double of(std::size_t k) const { return value[n.operands[k]]; }
        [[nodiscard]] bool less(std::size_t k, std::size_t l) const { return of(k) < of(l); }
        [[nodiscard]] bool less_equal(std::size_t k, std::size_t l) const { return of(k) <= of(l); }
        [[nodiscard]] bool holds(std::size_t k) const { return of(k) != 0; }
    };
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeNode& n = tape[i];
        const Judge judge{value, n};
        if (n.op == TapeOp::input) value[i] = inputs.at(n.operands[0]);
        else if (n.op == TapeOp::constant) value[i] = n.value;
        else if (is_decision(n.op)) value[i] = attribution::holds(n.op, judge) ? 1 : 0;
        else if (kind_of(n.op) == OperationKind::choice) value[i] = value[attribution::chosen_side(n, judge)];
        else {
            std::array<double, 3> operands{};
            for (std::size_t k = 0; k < 3; ++k)
                if (n.operands[k] != no_node) operands[k] = value[n.operands[k]];
            value[i] = attribution::result_of(n.op, operands, tape.format_of(i));
        }
    }
    const auto [hit, t, near, far] = tape.outputs;
    return {value[hit] != 0, value[t], value[near], value[far]};
}

}  // namespace

TEST_CASE("a form's tape run over columns has the bits of the form", "[tape]") {
    std::size_t same = 0;
    for (const char* name : {"f32", "f64"}) {
        const Format format = *find_format(name);
        for (const Intersector& form : intersect::table::catalogue()) {
            if (!form.exists_in(format) || !is_primitive(form.shape) || form.deciding_arithmetic) continue;
            const auto rays = draw(form, format);
            const auto found = in_columns(format, TapeProgram(record_tape(form, format)), rays);
            for (std::size_t i = 0; i < rays.size(); ++i) {
                INFO(form.info->name << ", ray " << i);
                REQUIRE(same_answer(found[i], plain(form, format, rays[i])));
                ++same;
            }
        }
    }
    CHECK(same > 15'000);
}

TEST_CASE("wider operations have the bits of a tape with those widths", "[tape]") {
    const Format format = *find_format("f32");
    Random random(7);
    std::size_t changed = 0;
    for (const Intersector& form : intersect::table::catalogue()) {
        if (!form.exists_in(format) || !is_primitive(form.shape) || form.deciding_arithmetic) continue;
        const Tape tape = record_tape(form, format);
        const auto rays = draw(form, format);
        for (int k = 0; k < 4; ++k) {
            std::vector<NodeId> wide;
            for (const NodeId i : find_widenable_operations(tape))
                if (random.unit() < 0.4) wide.push_back(i);
            const Tape wider = widen_operations(tape, wide, binary64);
            const auto found = in_columns(format, TapeProgram(wider), rays);
            for (std::size_t i = 0; i < rays.size(); ++i) {
                INFO(form.info->name << ", ray " << i);
                REQUIRE(same_answer(found[i], node_by_node(wider, rays[i])));
                if (!same_answer(found[i], plain(form, format, rays[i]))) ++changed;
            }
        }
    }
    CHECK(changed > 5'000);
}

TEST_CASE("a form all in double keeps all but one bit of float, and without wider operations it is unchanged",
          "[tape]") {
    const Format format = *find_format("f32");
    const Intersector& form = test::form_named("sphere.half_b");
    const Tape tape = record_tape(form, format);
    const auto all = find_widenable_operations(tape);
    const auto rays = draw(form, format);
    const auto none = in_columns(format, TapeProgram(widen_operations(tape, {}, binary64)), rays);
    int hits = 0;
    for (const bool two_words : {false, true}) {
        const auto wide =
            in_columns(format, TapeProgram(widen_operations(tape, all, wider_format(binary32, two_words))), rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            CHECK(same_answer(none[i], plain(form, format, rays[i])));
            const auto in_double = plain(form, *find_format("f64"), rays[i]);
            CHECK(wide[i].hit == in_double.hit);
            if (!in_double.hit) continue;
            ++hits;
            CHECK(std::fabs(wide[i].t - in_double.t) <= 0x1p-23 * std::fabs(in_double.t));
        }
    }
    CHECK(hits > 0);
}

TEST_CASE("a tape that cannot become a program is refused with the reason", "[tape]") {
    const Format format = *find_format("f32");
    CHECK_THROWS_WITH(record_tape(test::form_named("sdf.sphere_trace"), format), Catch::Contains("it marches"));
    const Intersector &filtered = test::form_named("triangle.filtered"), &box = test::form_named("box.signs");
    for (const Intersector* form :
         {&filtered,
          &intersect::transform::transformed_form(intersect::transform::default_transform_method(), filtered),
          &intersect::bounding_box::boxed_form(intersect::bounding_box::default_box_method(), box, filtered)})
        CHECK_THROWS_WITH(record_tape(*form, format), Catch::Contains("uses more precision where a ray needs it"));
    CHECK_THROWS_WITH(record_tape(test::form_named("sphere.press+box.signs"), format),
                      Catch::Contains("several forms"));
    CHECK_THROWS(arithmetic_of(bfloat16));
}

}  // namespace lostbits::test::test_tape_program
