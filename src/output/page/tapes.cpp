#include "output/page/tapes.hpp"

#include <fmt/format.h>
#include <gmp.h>

#include <memory>
#include <vector>

#include "intersect/table/recording.hpp"
#include "measure/blame/tape_text.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::output::page {

using scene::file::Scene;

namespace {

Json exact_json(double x) { return number_json(x); }

/// `"-1a2bp-12"`: m 2^e with m in hexadecimal.
Json exact_json(const Real& x) {
    if (mpfr_number_p(x.backend().data()) == 0) return number_json(static_cast<double>(x));
    mpz_t m;
    mpz_init(m);
    const mpfr_exp_t e = mpfr_zero_p(x.backend().data()) ? 0 : mpfr_get_z_2exp(m, x.backend().data());
    const std::unique_ptr<char, void (*)(void*)> digits(mpz_get_str(nullptr, 16, m), std::free);
    mpz_clear(m);
    return fmt::format("{}p{}", digits.get(), e);
}

template <class T>
Json exact_json(const Vec<T>& v) {
    return Json::array({exact_json(v.x), exact_json(v.y), exact_json(v.z)});
}

template <class T>
Json frame_json(const Scene& scene) {
    const auto f = scene::rays::make_frame<T>(scene);
    if (f.kind == scene::file::Camera::Kind::pixel_plane) {
        return {{"kind", "pixel_plane"},    {"origin", exact_json(f.origin)}, {"left", exact_json(f.left)},
                {"top", exact_json(f.top)}, {"pitch", exact_json(f.pitch)},   {"pitch_down", exact_json(f.pitch_down)}};
    }
    return {{"kind", f.kind == scene::file::Camera::Kind::orthographic ? "orthographic" : "pinhole"},
            {"normalise", f.normalise},
            {"origin", exact_json(f.origin)},
            {"right", exact_json(f.right)},
            {"up", exact_json(f.up)},
            {"forward", exact_json(f.forward)},
            {"pitch", exact_json(f.pitch)},
            {"centre_x", exact_json(f.centre_x)},
            {"centre_y", exact_json(f.centre_y)}};
}

template <class S>
Json numbers_of(const std::vector<Solid<S>>& solids, const std::set<int>& places) {
    Json all = Json::object();
    for (const int place : places) {
        all[std::to_string(place)] =
            array_of(solids.at(static_cast<std::size_t>(place)).used(), [](const S& x) { return exact_json(x); });
    }
    return all;
}

/// `{"add":"rounded",…}`: the kind of every operation there is.
Json operations_json() {
    Json all = Json::object();
    for (const TapeOpRow& row : tape_operations) all[std::string(row.name)] = row.kind_name;
    return all;
}

Json node_json(const TapeNode& n) {
    Json node{name_of(n.op), n.format};
    if (n.op == TapeOp::constant) {
        node.push_back(n.operands[0]);  // its value, which −1 may be
        return node;
    }
    for (const NodeId operand : n.operands) {
        if (operand != no_node) node.push_back(operand);
    }
    return node;
}

}  // namespace

Json camera_json(const Scene& scene) {
    return scene.inputs == scene::file::Inputs::own ? frame_json<Real>(scene) : frame_json<double>(scene);
}

Json solids_json(const Scene& scene, const std::set<int>& places) {
    return scene.inputs == scene::file::Inputs::own ? numbers_of(scene.solids(), places)
                                                    : numbers_of(scene::rays::shared_solids(scene), places);
}

Json tape_json(const intersect::table::Intersector& form, const Format& format) {
    Solid<double> solid;
    solid.shape = form.shape;
    solid.numbers = {1, 2, 3, 4, 5, 6};
    const intersect::Target<double> target(solid);
    Tape tape;
    form.record(format, {Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)}, target, HUGE_VAL, tape);
    const measure::blame::TapeText text(tape, intersect::table::input_names(form, target),
                                        measure::blame::TapeText::Style::pretty);
    Json nodes = Json::array(), names = Json::array(), expressions = Json::array(), definitions = Json::array(),
         operands = Json::array(), labelled = Json::array();
    for (NodeId i = 0; i < tape.size(); ++i) {
        nodes.push_back(node_json(tape[i]));
        names.push_back(text.name(i));
        expressions.push_back(text.expression(i));
        definitions.push_back(text.definition(i));
        operands.push_back(text.operand(i));
        labelled.push_back(tape[i].label.empty() ? 0 : 1);
    }
    return {{"operations", operations_json()},
            {"formats", array_of(tape.formats,
                                 [](const FloatFormat& f) {
                                     return Json{{"precision", f.precision}, {"emin", f.emin}, {"emax", f.emax}};
                                 })},
            {"nodes", std::move(nodes)},
            {"names", std::move(names)},
            {"expressions", std::move(expressions)},
            {"definitions", std::move(definitions)},
            {"operands", std::move(operands)},
            {"labelled", std::move(labelled)},
            {"outputs", Json::array({tape.outputs.hit, tape.outputs.t})}};
}

}  // namespace lostbits::output::page
