#include <algorithm>

#include "scene/file/tables.hpp"

namespace lostbits::scene::file {

using toml::TableReader;

namespace {

constexpr long long largest_exponent = 1000000;
constexpr long long max_ulps = 1LL << 30;

constexpr std::pair<std::string_view, ShadowRule::ShadowOffset> offset_names[] = {
    {"none", ShadowRule::ShadowOffset::none},
    {"epsilon", ShadowRule::ShadowOffset::epsilon},
    {"ulp", ShadowRule::ShadowOffset::ulp}};
constexpr std::pair<std::string_view, bool> surface_names[] = {{"ambient", false}, {"half_diffuse", true}};

void read_colour(TableReader& table, std::string_view key, Vec<Real>& colour) {
    table.read(key, colour);
    for (int i = 0; i < 3; ++i) {
        if (colour[i] < 0 || colour[i] > 1)
            table.fail_at(
                key,
                "is not between 0 and 1; a colour is [red, green, blue], each from 0 to 1 (a byte divided by 255)");
    }
}

void read_coefficient(TableReader& table, std::string_view key, Real& x, const StoredNumbers& numbers) {
    x = table.optional_number(key).value_or(x);
    if (x < 0) table.fail_at(key, "is negative and would take light away; write 0 or more");
    numbers.require_finite(table, key, x);
}

Vec<Real> read_light(TableReader table, const StoredNumbers& numbers) {
    const Vec<Real> position = table.vec3("position");
    table.require_known_keys();
    return numbers.require_finite(table, "position", position);
}

ShadowRule read_shadows(TableReader table, const StoredNumbers& numbers) {
    using ShadowOffset = ShadowRule::ShadowOffset;
    ShadowRule rule;

    table.read("surface", rule.keeps_half_diffuse, surface_names);
    read_coefficient(table, "background", rule.background, numbers);
    if (rule.background > 1)
        table.fail_at("background", "is above 1: a shadow would be brighter than the light; write 0 to 1");

    table.read("own", rule.tests_departed_sphere);
    table.read("offset", rule.offset, offset_names);
    read_coefficient(table, "epsilon", rule.epsilon, numbers);
    table.read("ulps", rule.ulps, 0, max_ulps);
    table.require_known_keys();  // in front of the keys that need another key, which may be the misspelt one

    if (!rule.tests_departed_sphere) {
        for (const char* key : {"offset", "epsilon", "ulps"})
            table.reject(key,
                         "needs own = true: without it a shadow ray is not tested against the sphere that it leaves");
    }

    if (rule.offset != ShadowOffset::epsilon) table.reject("epsilon", "needs offset = \"epsilon\"");
    else table.node("epsilon", "a number");
    if (rule.offset != ShadowOffset::ulp) table.reject("ulps", "needs offset = \"ulp\"");
    else table.node("ulps", "a whole number");
    return rule;
}

/// Reads the paint of one table over the given defaults.
void read_paint(TableReader& table, Material& material, const StoredNumbers& numbers) {
    read_colour(table, "colour", material.colour);
    read_coefficient(table, "ka", material.ambient, numbers);
    read_coefficient(table, "kd", material.diffuse, numbers);
    read_coefficient(table, "ks", material.specular, numbers);
    table.read("n", material.exponent, 1, largest_exponent);
}

}  // namespace

bool Appearance::has_stage(Stage stage) const {
    switch (stage) {
        case Stage::visible: return true;
        case Stage::diffuse: return light.has_value();
        case Stage::shadows: return shadows.has_value();
        case Stage::phong: return std::ranges::any_of(materials, [](const Material& m) { return m.specular > 0; });
    }
    return false;
}

Stage Appearance::last_stage_up_to(Stage limit) const {
    for (const Stage stage : {Stage::phong, Stage::shadows, Stage::diffuse}) {
        if (stage <= limit && has_stage(stage)) return stage;
    }
    return Stage::visible;
}

Appearance read_appearance(TableReader& file, const StoredNumbers& numbers) {
    Appearance appearance;
    read_colour(file, "background", appearance.background);
    if (auto table = file.optional_table("light")) appearance.light = read_light(*table, numbers);
    if (auto table = file.optional_table("shadows")) appearance.shadows = read_shadows(*table, numbers);
    if (appearance.shadows && !appearance.light)
        file.fail_at("shadows", "need a light to cast them; add [light] with position = [x, y, z]");
    if (auto table = file.optional_table("material")) {
        read_paint(*table, appearance.base, numbers);
        table->require_known_keys();
    }
    return appearance;
}

Material read_material(TableReader& sphere, const Appearance& appearance, const StoredNumbers& numbers) {
    Material material = appearance.base;
    read_paint(sphere, material, numbers);
    if (material.specular > 0 && !appearance.light)
        sphere.fail_at("ks",
                       "above 0 asks for a highlight, which needs a light; add [light] with position = [x, y, z]");
    return material;
}

}  // namespace lostbits::scene::file
