#include "output/page/tapes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmp.h>

#include <memory>
#include <vector>

#include "intersect/table/recording.hpp"
#include "measure/blame/tape_text.hpp"
#include "output/page/text.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::output::page {

using scene::file::Scene;

namespace {

std::string exact_text(double x) { return number(x); }

/// `"-1a2bp-12"`: m 2^e with m in hexadecimal.
std::string exact_text(const Real& x) {
    if (mpfr_number_p(x.backend().data()) == 0) return number(static_cast<double>(x));
    mpz_t m;
    mpz_init(m);
    const mpfr_exp_t e = mpfr_zero_p(x.backend().data()) ? 0 : mpfr_get_z_2exp(m, x.backend().data());
    const std::unique_ptr<char, void (*)(void*)> digits(mpz_get_str(nullptr, 16, m), std::free);
    mpz_clear(m);
    return fmt::format("\"{}p{}\"", digits.get(), e);
}

template <class T>
std::string exact_text(const Vec<T>& v) {
    return fmt::format("[{},{},{}]", exact_text(v.x), exact_text(v.y), exact_text(v.z));
}

template <class T>
std::string frame_json(const Scene& scene) {
    const auto f = scene::rays::make_frame<T>(scene);
    if (f.kind == scene::file::Camera::Kind::pixel_plane) {
        return fmt::format(R"({{"kind":"pixel_plane","origin":{},"left":{},"top":{},"pitch":{},"pitch_down":{}}})",
                           exact_text(f.origin), exact_text(f.left), exact_text(f.top), exact_text(f.pitch),
                           exact_text(f.pitch_down));
    }
    return fmt::format(
        R"({{"kind":"{}","normalise":{},"origin":{},"right":{},"up":{},"forward":{},"pitch":{},"centre_x":{},"centre_y":{}}})",
        f.kind == scene::file::Camera::Kind::orthographic ? "orthographic" : "pinhole", f.normalise,
        exact_text(f.origin), exact_text(f.right), exact_text(f.up), exact_text(f.forward), exact_text(f.pitch),
        exact_text(f.centre_x), exact_text(f.centre_y));
}

template <class S>
std::string numbers_of(const std::vector<Solid<S>>& solids, const std::set<int>& places) {
    std::vector<std::string> all;
    for (const int place : places) {
        std::vector<std::string> numbers;
        for (const S& x : solids.at(static_cast<std::size_t>(place)).used()) numbers.push_back(exact_text(x));
        all.push_back(fmt::format("\"{}\":[{}]", place, fmt::join(numbers, ",")));
    }
    return fmt::format("{{{}}}", fmt::join(all, ","));
}

/// `{"add":"rounded",…}`: the kind of every operation there is.
std::string operations_json() {
    std::vector<std::string> all;
    for (const TapeOpRow& row : tape_operations) all.push_back(fmt::format(R"("{}":"{}")", row.name, row.kind_name));
    return fmt::format("{{{}}}", fmt::join(all, ","));
}

std::string node_json(const TapeNode& n) {
    std::string text = fmt::format("[\"{}\",{}", name_of(n.op), n.format);
    if (n.op == TapeOp::constant) return text + fmt::format(",{}]", n.operands[0]);  // its value, which −1 may be
    for (const NodeId operand : n.operands) {
        if (operand != no_node) text += fmt::format(",{}", operand);
    }
    return text + "]";
}

}  // namespace

std::string camera_json(const Scene& scene) {
    return scene.inputs == scene::file::Inputs::own ? frame_json<Real>(scene) : frame_json<double>(scene);
}

std::string solids_json(const Scene& scene, const std::set<int>& places) {
    return scene.inputs == scene::file::Inputs::own ? numbers_of(scene.solids(), places)
                                                    : numbers_of(scene::rays::shared_solids(scene), places);
}

std::string tape_json(const intersect::table::Intersector& form, const Format& format) {
    Solid<double> solid;
    solid.shape = form.shape;
    solid.numbers = {1, 2, 3, 4, 5, 6};
    const intersect::Target<double> target(solid);
    Tape tape;
    form.record(format, {Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)}, target, HUGE_VAL, tape);
    const measure::blame::TapeText text(tape, intersect::table::input_names(form, target),
                                        measure::blame::TapeText::Style::pretty);
    std::vector<std::string> formats, nodes, names, expressions, definitions, operands, labelled;
    for (const FloatFormat& f : tape.formats)
        formats.push_back(fmt::format(R"({{"precision":{},"emin":{},"emax":{}}})", f.precision, f.emin, f.emax));
    for (NodeId i = 0; i < tape.size(); ++i) {
        nodes.push_back(node_json(tape[i]));
        names.push_back(json_text(text.name(i)));
        expressions.push_back(json_text(text.expression(i)));
        definitions.push_back(json_text(text.definition(i)));
        operands.push_back(json_text(text.operand(i)));
        labelled.push_back(tape[i].label.empty() ? "0" : "1");
    }
    return fmt::format(
        R"({{"operations":{},"formats":[{}],"nodes":[{}],"names":[{}],"expressions":[{}],"definitions":[{}],"operands":[{}],"labelled":[{}],"outputs":[{},{}]}})",
        operations_json(), fmt::join(formats, ","), fmt::join(nodes, ","), fmt::join(names, ","),
        fmt::join(expressions, ","), fmt::join(definitions, ","), fmt::join(operands, ","), fmt::join(labelled, ","),
        tape.outputs.hit, tape.outputs.t);
}

}  // namespace lostbits::output::page
