#include <algorithm>

#include "scene/file/tables.hpp"

namespace lostbits::scene::file {

using toml::TableReader;

namespace {

constexpr long long largest_exponent = 1000000;
constexpr long long most_ulps = 1LL << 30;

constexpr std::pair<std::string_view, ShadowRule::Offset> offset_names[] = {
    {"none", ShadowRule::Offset::none}, {"epsilon", ShadowRule::Offset::epsilon}, {"ulp", ShadowRule::Offset::ulp}};
constexpr std::pair<std::string_view, bool> surface_names[] = {{"ambient", false}, {"half_diffuse", true}};

Vec<Real> read_colour(TableReader& table, std::string_view key, const Vec<Real>& otherwise) {
    const auto colour = table.optional_vec3(key);
    if (!colour) return otherwise;
    for (int i = 0; i < 3; ++i) {
        if ((*colour)[i] < 0 || (*colour)[i] > 1)
            table.fail_at(
                key,
                "is not between 0 and 1; a colour is [red, green, blue], each from 0 to 1 (a byte divided by 255)");
    }
    return *colour;
}

Real read_coefficient(TableReader& table, std::string_view key, const Real& otherwise, const StoredNumbers& numbers) {
    const auto x = table.optional_number(key);
    if (!x) return otherwise;
    if (*x < 0) table.fail_at(key, "is negative and would take light away; write 0 or more");
    return numbers.finite(table, key, *x);
}

Vec<Real> read_light(TableReader table, const StoredNumbers& numbers) {
    const Vec<Real> at = table.vec3("position");
    table.reject_unknown_keys();
    return numbers.finite(table, "position", at);
}

ShadowRule read_shadows(TableReader table, const StoredNumbers& numbers) {
    using Offset = ShadowRule::Offset;
    ShadowRule rule;
    rule.half_diffuse = table.optional_one_of<bool>("surface", surface_names).value_or(false);
    rule.background = read_coefficient(table, "background", rule.background, numbers);
    if (rule.background > 1)
        table.fail_at("background", "is above 1: a shadow would be brighter than the light; write 0 to 1");
    rule.own = table.optional_boolean("own").value_or(false);
    if (!rule.own) {
        for (const char* key : {"offset", "epsilon", "ulps"})
            table.reject(key,
                         "needs own = true: without it a shadow ray is not tested against the sphere that it leaves");
    }
    rule.offset = table.optional_one_of<Offset>("offset", offset_names).value_or(Offset::none);
    if (rule.offset == Offset::epsilon)
        rule.epsilon = read_coefficient(table, "epsilon", table.number("epsilon"), numbers);
    else table.reject("epsilon", "needs offset = \"epsilon\"");
    if (rule.offset == Offset::ulp) rule.ulps = static_cast<int>(table.integer("ulps", 0, most_ulps));
    else table.reject("ulps", "needs offset = \"ulp\"");
    table.reject_unknown_keys();
    return rule;
}

/// The paint of one table over what it is otherwise.
Material read_paint(TableReader& table, const Material& otherwise, const StoredNumbers& numbers) {
    Material material;
    material.colour = read_colour(table, "colour", otherwise.colour);
    material.ambient = read_coefficient(table, "ka", otherwise.ambient, numbers);
    material.diffuse = read_coefficient(table, "kd", otherwise.diffuse, numbers);
    material.specular = read_coefficient(table, "ks", otherwise.specular, numbers);
    material.exponent = static_cast<int>(table.optional_integer("n", 1, largest_exponent).value_or(otherwise.exponent));
    return material;
}

}  // namespace

bool Appearance::asks_for(Stage stage) const {
    switch (stage) {
        case Stage::visible: return true;
        case Stage::diffuse: return light.has_value();
        case Stage::shadows: return shadows.has_value();
        case Stage::phong: return std::ranges::any_of(materials, [](const Material& m) { return m.specular > 0; });
    }
    return false;
}

Stage Appearance::last_up_to(Stage limit) const {
    for (const Stage stage : {Stage::phong, Stage::shadows, Stage::diffuse}) {
        if (stage <= limit && asks_for(stage)) return stage;
    }
    return Stage::visible;
}

Appearance read_appearance(TableReader& file, const StoredNumbers& numbers) {
    Appearance look;
    look.background = read_colour(file, "background", look.background);
    if (auto table = file.optional_table("light")) look.light = read_light(*table, numbers);
    if (auto table = file.optional_table("shadows")) look.shadows = read_shadows(*table, numbers);
    if (look.shadows && !look.light)
        file.fail_at("shadows", "need a light to cast them; add [light] with position = [x, y, z]");
    if (auto table = file.optional_table("material")) {
        look.base = read_paint(*table, look.base, numbers);
        table->reject_unknown_keys();
    }
    return look;
}

Material read_material(TableReader& sphere, const Appearance& look, const StoredNumbers& numbers) {
    const Material material = read_paint(sphere, look.base, numbers);
    if (material.specular > 0 && !look.light)
        sphere.fail_at("ks",
                       "above 0 asks for a highlight, which needs a light; add [light] with position = [x, y, z]");
    return material;
}

}  // namespace lostbits::scene::file
