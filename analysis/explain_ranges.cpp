#include "explain_ranges.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "analysis/choice/ray_numbers.hpp"
#include "analysis/choice/select.hpp"
#include "measure/apriori/ranges.hpp"
#include "output/blame/ranges_text.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::analysis {

using measure::apriori::Asked;
using measure::apriori::RangesRequest;

namespace {

void refuse_ray(const choice::RayWords& ray) {
    const std::array words{std::pair{"--pixel", !ray.pixel.empty()}, std::pair{"--worst", ray.worst},
                           std::pair{"--ray", !ray.ray.empty()}, std::pair{"--case", !ray.named_case.empty()}};
    for (const auto& [option, given] : words)
        if (given)
            throw InputError(
                fmt::format("--ranges, {}: a bound over ranges is of all rays of a scene, and {} names "
                            "one; leave out either",
                            option, option));
    if (ray.subject.empty())
        throw InputError(
            "--ranges: the ranges are those of the rays of a scene; name one, and give other ranges by "
            "--range NAME=LOW..HIGH");
}

/// `d.x=-0.5..0.5`, in the place of the scene's range.
Asked range_named(const std::string& text) {
    const auto equals = text.find('='), dots = text.find("..", equals == std::string::npos ? 0 : equals);
    if (equals == std::string::npos || dots == std::string::npos)
        throw InputError("--range " + text + ": is not a range; write NAME=LOW..HIGH, such as d.x=-0.5..0.5");
    const auto end = [&](const std::string& number) {
        const auto x = choice::numbers_of(number, {"--range", "an end of a range; write a number", 1}, {});
        return scene::toml::round_to_format(x.front(), binary64);
    };
    const Asked asked{text.substr(0, equals),
                      {end(text.substr(equals + 1, dots - equals - 1)), end(text.substr(dots + 2))}};
    if (asked.range.low > asked.range.high)
        throw InputError("--range " + text + ": ends before it begins; write the smaller number first");
    return asked;
}

}  // namespace

Exit explain_ranges(const choice::RayWords& ray, const RangeWords& words, const measure::map::MapRow& row, bool json,
                    const Common& common) {
    refuse_ray(ray);
    RangesRequest request{.form = row.form, .format = row.format, .boxes = static_cast<std::size_t>(words.boxes)};
    for (const std::string& text : words.ranges) request.asked.push_back(range_named(text));
    const auto scene = choice::load_one_scene(
        {.names = {ray.subject}, .size = ray.size, .variant = ray.variant, .set = ray.set, .stop = common.stop},
        choice::data_folder(common.data));
    if (scene.meets(request.form->shapes().placed()) && is_solid(request.form->shape) && !request.form->is_placed &&
        !scene.meets(request.form->shapes()))
        request.form = &intersect::space::through(intersect::space::usual_space(), *request.form);
    if (!scene.meets(request.form->shapes()))
        throw NothingSelected(
            fmt::format("{} is not a form for the solids of {}; `lostbits list forms` shows which are",
                        request.form->info->name, scene.id));
    request.scene = &scene;
    request.limit.stop = common.stop;
    const choice::ThreadLimit limit(common.threads);
    const auto bound = measure::apriori::bound_over_ranges(request);
    fmt::print("{}", json ? output::blame::ranges_json(request, bound) : output::blame::ranges_text(request, bound));
    return Exit::done;
}

}  // namespace lostbits::analysis
