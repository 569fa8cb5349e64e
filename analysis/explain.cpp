#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "lost_numbers.hpp"
#include "measure/answer/one_ray.hpp"
#include "output/blame/explain_programs.hpp"
#include "output/blame/explain_text.hpp"
#include "output/blame/march_text.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/parse_number.hpp"
#include "scene/toml/round.hpp"
#include "select.hpp"

namespace lostbits::analysis {

using scene::file::Scene;

namespace {

struct ExplainOptions {
    std::string scene, form, format = "f32";
    std::string pixel, ray, size;
    std::vector<std::string> set;
    bool json = false, fpcore = false, latex = false, c = false;
};

std::vector<std::string> parts_of(const std::string& text) {
    std::vector<std::string> parts{""};
    for (const char c : text) {
        if (c == ',') parts.emplace_back();
        else if (c != ' ') parts.back() += c;
    }
    return parts;
}

/// The scene of that name: one alone.
Scene load_one(const ExplainOptions& o, const Common& common) {
    const scene::file::SceneName name = scene::file::find_scene(o.scene, data_folder(common.data));
    scene::file::LoadOptions options{.variant = name.variant};
    if (!o.size.empty()) options.size = parse_size(o.size);
    for (const auto& s : o.set) options.overrides.push_back(scene::toml::parse_override(s));
    auto scenes = scene::file::load_scene(name.path, options);
    if (scenes.size() != 1) throw InputError(o.scene + ": has variants; name one, such as " + scenes.front().id);
    return std::move(scenes.front());
}

/// One number of `--pixel`, or of `--ray`, which is rounded to binary32.
double number_of(const std::string& text, bool pixel) {
    const char* const option = pixel ? "--pixel" : "--ray";
    const auto read = scene::toml::parse_number(text);
    const auto* const fault = std::get_if<scene::toml::NumberFault>(&read);
    if (fault && !fault->too_large) throw InputError(fmt::format("{}: \"{}\" {}", option, text, fault->why));
    if (pixel) return fault ? HUGE_VAL : static_cast<double>(std::get<Real>(read));
    const double x = fault ? HUGE_VAL : scene::toml::round_to_format(std::get<Real>(read), binary32);
    if (!std::isfinite(x)) {
        constexpr double largest = std::numeric_limits<float>::max();
        throw InputError(
            fmt::format("--ray: \"{}\" is out of range: rays are stored in binary32, whose largest number is {} ({}); "
                        "scale the scene and the ray down",
                        text, output::file::decimal(largest), output::file::hex(largest)));
    }
    return x;
}

measure::answer::OneRay ray_of(const ExplainOptions& o, const Scene& scene) {
    if (o.pixel.empty() == o.ray.empty())
        throw InputError("explain: name one ray: --pixel X,Y of the scene, or --ray OX,OY,OZ,DX,DY,DZ");
    const bool pixel = !o.pixel.empty();
    const auto parts = parts_of(pixel ? o.pixel : o.ray);
    std::vector<double> x;
    for (const std::string& part : parts) x.push_back(number_of(part, pixel));
    if (pixel) {
        constexpr double most = 1e9;  // more than any picture has, less than an int
        if (x.size() != 2 || std::ranges::any_of(x, [](double v) { return v != std::floor(v) || std::fabs(v) > most; }))
            throw InputError("--pixel " + o.pixel + ": is not a pixel; write its column and row, like 17,42");
        return {scene, static_cast<int>(x[0]), static_cast<int>(x[1])};
    }
    if (x.size() != 6)
        throw InputError("--ray " + o.ray +
                         ": is not a ray; write origin and direction, six numbers with commas between them");
    const Ray<double> ray{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
    if (!measure::truth::is_proper(ray))
        throw InputError("--ray " + o.ray +
                         ": is not a ray in binary32; its numbers must be finite and its direction not zero");
    return {scene, ray};
}

Exit run(const ExplainOptions& o, const Common& common) {
    const Scene scene = load_one(o, common);
    const auto forms = select_forms({o.form});
    const auto formats = select_formats({o.format});
    if (forms.size() != 1 || formats.size() != 1) throw InputError("explain: name one form and one format");
    const intersect::table::Intersector& form = *forms.front();
    if (!scene.meets(form.shape)) {
        const std::string lacks = form.shape == Shape::sdf   ? "no [march] table, which the forms of sdf.* need"
                                  : form.shape == Shape::box ? "no solids for it: it is a form for boxes"
                                                             : "no solids for it: it is a form for spheres";
        throw InputError(fmt::format("-i {}: scene {} has {}; try -i '{}'", o.form, scene.id, lacks,
                                     globs_of([&](Shape shape) { return scene.meets(shape); })));
    }
    if (!form.exists_in(formats.front()))
        throw InputError(
            fmt::format("-i {}: this form does not exist in {}, only in f32; try -f f32", o.form, o.format));
    const measure::answer::OneRay ray = ray_of(o, scene);
    if (!common.quiet) note_lost_numbers(scene, {{&form, formats.front()}});
    const measure::blame::Explanation x = measure::blame::explain(form, formats.front(), ray);
    if (o.json) fmt::print("{}", output::blame::explain_json(x));
    else if (o.fpcore) fmt::print("{}", output::blame::explain_fpcore(x));
    else if (o.latex) fmt::print("{}", output::blame::explain_latex(x));
    else if (o.c) fmt::print("{}", output::blame::explain_c(x));
    else {
        if (form.log) fmt::print("{}\n", output::blame::march_table(form, formats.front(), ray));
        fmt::print("{}", output::blame::explain_text(x, common.verbose));
    }
    return Exit::done;
}

}  // namespace

void add_explain(CLI::App& program, const Common& common, Command& chosen) {
    auto* command =
        program.add_subcommand("explain", "One ray of a scene, operation by operation: which one loses the bits");
    const auto o = std::make_shared<ExplainOptions>();
    command->add_option("SCENE", o->scene, "A scene file, or a name in data/scenes")->required();
    command->add_option("--pixel", o->pixel, "Column and row of a pixel, from the left and from the top: 17,42");
    command->add_option("--size", o->size, "Size of the picture that contains the pixel, WxH (default: the scene's)");
    command->add_option(
        "--ray", o->ray,
        "A ray among the scene's solids: OX,OY,OZ,DX,DY,DZ, decimals or hexadecimal floats, rounded once to binary32");
    command->add_option("-i,--intersector", o->form, "The form")->required();
    command->add_option("-f,--format", o->format, "The format (default: f32)");
    command->add_option("--set", o->set, "Change a number of the scene first: march.hit_eps=1e-6");
    auto* const as = command->add_option_group("as", "Instead of the table");
    as->add_flag("--json", o->json, "Everything, as JSON");
    as->add_flag("--fpcore", o->fpcore, "FPCore 2.0 of t, for Herbie and FPBench");
    as->add_flag("--latex", o->latex, "The operations as a LaTeX align*");
    as->add_flag(
        "--c", o->c,
        "A C program that reproduces t to the bit; a form with a fused multiply-add or a step to the next number: in "
        "f32 and f64 alone");
    as->require_option(0, 1);
    command->callback([o, &common, &chosen] { chosen = [o, &common] { return run(*o, common); }; });
}

}  // namespace lostbits::analysis
