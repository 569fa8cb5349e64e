#include "output/attribution/explain_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "intersect/process/child.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::attribution {

std::string shell_word(std::string_view word) { return intersect::process::shell_word(word); }

std::string name_of_pixel(const std::string& scene, int x, int y) {
    return fmt::format("{} --pixel {},{}", scene, x, y);
}

std::string name_of_ray(const scene::rays::RayGroup* one) {
    if (one == nullptr) return "";
    std::string text;
    for (const Primitive<double>& primitive : one->primitives) {
        text +=
            fmt::format("--{}={}", lostbits::name_of(primitive.shape), file::listed(primitive.used(), file::hex, ","));
        if (const auto& placed = primitive.placed)
            text += fmt::format("@{}{}", placed->is_inverse ? "/" : "", file::listed(placed->matrix, file::hex, ","));
        text += ' ';
    }
    const Ray<double> ray = one->rays[0];
    text += "--ray=" + file::listed(std::array{ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                                               ray.direction.y, ray.direction.z},
                                    file::hex, ",");
    const Range<double> range = one->rays.range(0);
    if (range.tmin != 0) text += " --tmin=" + file::hex(range.tmin);
    if (!std::isinf(range.tmax)) text += " --tmax=" + file::hex(range.tmax);
    if (range.open.tmin || range.open.tmax) text += fmt::format(" --open-ends {}", lostbits::name_of(range.open));
    if (!one->march) return text;
    std::size_t place = 0;
    transformed(*one->march, [&](double x) {
        text += fmt::format(" --set march.{}={}", intersect::march_number_names[place++], file::hex(x));
        return x;
    });
    return text + fmt::format(" --set march.max_steps={} --set march.secant_steps={} --set march.bisect_steps={}",
                              one->march->max_steps, one->march->secant_steps, one->march->bisect_steps);
}

namespace {

std::string& plugin_options_text() {
    static std::string words;
    return words;
}

}  // namespace

void set_plugin_options(const std::string& words) { plugin_options_text() = words; }

const std::string& plugin_options() { return plugin_options_text(); }

std::string plugin_options_for(std::string_view form) {
    const bool own =
        std::ranges::any_of(intersect::table::catalogue(), [form](const auto& row) { return row.info->name == form; });
    return own || form.empty() ? "" : plugin_options_text();
}

std::string explain_command(const std::string& name, const measure::evaluate::TestedForm& row) {
    if (!row.form->native32 && !row.form->native64) return "";
    return fmt::format("lostbits explain {} -i {} -f {}{}{}", name, row.form->info->name, row.format.name,
                       row.judged ? fmt::format(" --convention {}", intersect::convention_name(row.judged)) : "",
                       plugin_options_for(row.form->info->name));
}

}  // namespace lostbits::output::attribution
