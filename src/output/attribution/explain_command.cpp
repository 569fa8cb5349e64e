#include "output/attribution/explain_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "output/file/number_text.hpp"

namespace lostbits::output::attribution {

std::string explain_pixel_arguments(const std::string& scene, int x, int y) {
    return fmt::format("{} --pixel {},{}", scene, x, y);
}

std::string explain_ray_arguments(const scene::rays::RayGroup* group) {
    if (group == nullptr) return "";

    // The primitives, each with its matrix.
    std::string text;
    for (const Primitive<double>& primitive : group->primitives) {
        text += fmt::format("--{}={}", lostbits::name_of(primitive.shape),
                            file::number_list(primitive.shape_numbers(), file::hex, ","));
        if (const auto& transform = primitive.transform)
            text += fmt::format("@{}{}", transform->is_inverse ? "/" : "",
                                file::number_list(transform->matrix, file::hex, ","));
        text += ' ';
    }

    // The ray, and the ends of its range that are not the usual ones.
    const Ray<double> ray = group->rays[0];
    text += "--ray=" + file::number_list(std::array{ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                                                    ray.direction.y, ray.direction.z},
                                         file::hex, ",");
    const Range<double> range = group->rays.range(0);
    if (range.tmin != 0) text += " --tmin=" + file::hex(range.tmin);
    if (!std::isinf(range.tmax)) text += " --tmax=" + file::hex(range.tmax);
    if (range.open_ends.tmin || range.open_ends.tmax)
        text += fmt::format(" --open-ends {}", lostbits::name_of(range.open_ends));

    // The constants of a march, in the order of their names.
    if (!group->march) return text;
    std::size_t constant_index = 0;
    convert_numbers(*group->march, [&](double x) {
        text += fmt::format(" --set march.{}={}", intersect::march_number_names[constant_index++], file::hex(x));
        return x;
    });
    return text + fmt::format(" --set march.max_steps={} --set march.secant_steps={} --set march.bisect_steps={}",
                              group->march->max_steps, group->march->secant_steps, group->march->bisect_steps);
}

namespace {

std::string& plugin_options_text() {
    static std::string text;
    return text;
}

}  // namespace

void set_plugin_options(const std::string& options) { plugin_options_text() = options; }

const std::string& plugin_options() { return plugin_options_text(); }

std::string plugin_options_for(std::string_view form) {
    const bool is_in_catalogue = std::ranges::any_of(intersect::table::catalogue(),
                                                     [form](const auto& known) { return known.info->name == form; });
    return is_in_catalogue || form.empty() ? "" : plugin_options_text();
}

std::string explain_command(const std::string& arguments, const measure::evaluate::TestedForm& tested_form) {
    if (!tested_form.form->native32 && !tested_form.form->native64) return "";
    return fmt::format(
        "lostbits explain {} -i {} -f {}{}{}", arguments, tested_form.form->info->name, tested_form.format.name,
        tested_form.touching ? fmt::format(" --convention {}", intersect::convention_name(tested_form.touching)) : "",
        plugin_options_for(tested_form.form->info->name));
}

}  // namespace lostbits::output::attribution
