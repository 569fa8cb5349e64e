// Expressions as rebuilt from the tape.
#include "measure/attribution/tape_text.hpp"

#include <set>

#include "catch.hpp"
#include "intersect/table/recording.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "measure/rows.hpp"

namespace lostbits::test::test_tape_text {

using intersect::table::Intersector;
using measure::attribution::TapeText;

namespace {

struct Recording {
    explicit Recording(std::string_view name) : form(test::form_named(name)) {
        Random random(3);
        setting = draw_setting(random, form, *find_format("f32"), 1);
        form.record(*find_format("f32"), setting.ray, setting.target(form), HUGE_VAL, tape);
    }
    [[nodiscard]] TapeText text(TapeText::TextStyle style) const {
        return {tape, intersect::table::input_names(form, setting.target(form)), style};
    }
    [[nodiscard]] NodeId labelled(std::string_view label) const {
        for (NodeId i = 0; i < tape.size(); ++i) {
            if (tape[i].label == label) return i;
        }
        return no_node;
    }
    const Intersector& form;
    Setting setting;
    Tape tape;
};

}  // namespace

TEST_CASE("the tape of the schoolbook form reads like its source", "[attribution]") {
    const Recording r("sphere.schoolbook");
    const TapeText plain = r.text(TapeText::TextStyle::plain), pretty = r.text(TapeText::TextStyle::pretty);
    CHECK(plain.definition(r.labelled("a")) == "a = dot(d, d)");
    CHECK(pretty.definition(r.labelled("c")) == "c = (o − centre)·(o − centre) − radius·radius");
    CHECK(plain.definition(r.labelled("disc")) == "disc = b*b - 4*a*c");
    CHECK(plain.definition(r.labelled("b")) == "b = 2*dot(o - centre, d)");
}

TEST_CASE("the axes of a box share categories and differ in names", "[attribution]") {
    const Recording r("box.inclusive");
    const TapeText text = r.text(TapeText::TextStyle::plain), generic = r.text(TapeText::TextStyle::generic);
    std::set<std::string> names, categories;
    for (NodeId i = 0; i < r.tape.size(); ++i) {
        if (r.tape[i].label != "inv") continue;
        names.insert(text.name(i));
        categories.insert(generic.category(i));
    }
    CHECK(names == std::set<std::string>{"inv", "inv2", "inv3"});
    CHECK(categories == std::set<std::string>{"inv = 1/d.i"});
}

TEST_CASE("the second of two names that end in a digit does not get a larger digit", "[attribution]") {
    Recording r("sphere.schoolbook");
    const NodeId first = r.labelled("a"), second = r.labelled("b");
    for (const NodeId i : {first, second}) r.tape[i].label = "A^-1";
    const TapeText text = r.text(TapeText::TextStyle::pretty);
    CHECK(text.name(first) == "A^-1");
    CHECK(text.name(second) == "A^-1_2");
}

TEST_CASE("names on a tape are unique and become unique C identifiers", "[attribution]") {
    for (const Intersector& form : intersect::table::intersectors()) {
        const Recording r(form.info->name);
        const TapeText text = r.text(TapeText::TextStyle::plain);
        std::set<std::string> names, identifiers;
        for (NodeId i = 0; i < r.tape.size(); ++i) {
            if (r.tape[i].op == TapeOp::constant) continue;
            INFO(form.info->name << " " << text.name(i));
            CHECK(names.insert(text.name(i)).second);
            CHECK(identifiers.insert(text.identifier(i)).second);
            CHECK_FALSE(std::isdigit(static_cast<unsigned char>(text.identifier(i).front())));
            CHECK(std::ranges::all_of(text.identifier(i),
                                      [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }));
        }
    }
}

TEST_CASE("every operation of any tape has a category of the tape of all operations", "[attribution]") {
    const Format f32 = *find_format("f32");
    for (const Intersector& form : intersect::table::intersectors()) {
        Random random(5);
        std::set<std::string> known;
        for (int i = 0; i < 20; ++i) {
            const Setting s = draw_setting(random, form, f32, i < 10 ? 1 : 8);
            Tape tape;
            if (known.empty()) {
                form.record_all(s.target(form), tape);
                const TapeText text(tape, intersect::table::input_names(form, s.target(form)),
                                    TapeText::TextStyle::generic);
                for (NodeId n = 0; n < tape.size(); ++n) known.insert(text.category(n));
            }
            form.record(f32, s.ray, s.target(form), HUGE_VAL, tape);
            const TapeText text(tape, intersect::table::input_names(form, s.target(form)),
                                TapeText::TextStyle::generic);
            for (NodeId n = 0; n < tape.size(); ++n) {
                if (!is_operation(tape[n].op)) continue;
                INFO(form.info->name << ": " << text.category(n));
                CHECK(known.contains(text.category(n)));
            }
        }
    }
}

}  // namespace lostbits::test::test_tape_text
