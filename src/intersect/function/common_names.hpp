// Names that users give to rays, to the parts of primitives, and to functions.
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "shapes/primitive.hpp"

namespace lostbits::intersect::function {

/// Returns the name in lower case and without underscores.
inline std::string normalise_name(std::string_view name) {
    std::string normalized;
    for (const char c : name)
        if (c != '_') normalized += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return normalized;
}

inline bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, name) != names.end();
}

inline bool is_origin_name(std::string_view name) {
    return is_one_of(
        name, {"o",        "ro",    "org", "orig", "origin", "rayo", "rayorg", "rayorig", "rayorigin", "rayori", "pos",
               "position", "start", "eye", "from", "src",    "ori",  "rpos",   "raypos",  "p0",        "e",      "a"});
}
inline bool is_direction_name(std::string_view name) {
    return is_one_of(name, {"d", "rd", "dir", "direction", "raydir", "raydirection", "rayd", "rdir", "v", "dirn", "b"});
}
inline bool is_inverse_direction_name(std::string_view name) {
    return is_one_of(name, {"inv", "invd", "invdir", "rcpdir", "invdirection", "invraydir", "dirinv", "idir", "dinv",
                            "invrd", "raydirinv", "inverse", "inversedirection", "rinv", "rayinv", "invray"});
}
inline bool is_tmin_name(std::string_view name) {
    return is_one_of(name, {"tmin", "mint", "tstart", "tnear", "raytmin", "near"});
}
inline bool is_tmax_name(std::string_view name) {
    return is_one_of(name, {"tmax", "maxt", "tend", "tfar", "raytmax", "far", "maxdist", "maxdistance", "length"});
}

inline bool is_hit_name(std::string_view name) {
    return is_one_of(name, {"hit", "ishit", "didhit", "valid", "ok", "hashit", "found", "intersects", "intersected",
                            "success", "happened"});
}
inline bool is_t_name(std::string_view name) {
    return is_one_of(
        name, {"t",    "dist",    "distance",    "depth",  "thit",  "tnear",  "t0",   "lambda", "near", "tmin",
               "hitt", "hitdist", "hitdistance", "tentry", "enter", "tenter", "outt", "0",      "x",    "length"});
}
inline bool is_far_name(std::string_view name) {
    return is_one_of(name, {"far", "tfar", "t1", "tmax", "texit", "exit", "tleave", "1", "y"});
}
inline bool is_radius_name(std::string_view name) { return is_one_of(name, {"r", "rad", "radius", "sr", "ra"}); }

/// True if users commonly give this name to the key with index `k` of a shape. `name` is normalized.
inline bool is_common_name_of_key(std::string_view name, const Key& key, std::size_t k, Shape shape) {
    if (name == normalise_name(key.name) || std::ranges::find(key.aliases, name) != key.aliases.end()) return true;

    // Spheres
    if (key.name == "centre")
        return is_one_of(name, {"c", "center", "centre", "pos", "position", "sc", "cen", "ctr", "p", "origin", "ce",
                                "spherecenter", "spherecentre", "sphere", "location"});
    if (key.name == "radius") return is_one_of(name, {"r", "rad", "radius", "ra", "sphereradius", "sr"});

    // Boxes
    if (key.name == "lo")
        return is_one_of(
            name, {"lo", "low",     "min",     "mn",   "bmin",     "boxmin", "aabbmin",   "minp",  "lower", "pmin",
                   "b0", "bounds0", "minimum", "vmin", "minbound", "l",      "mincorner", "bbmin", "lb",    "box0"});
    if (key.name == "hi")
        return is_one_of(
            name, {"hi", "high",    "max",     "mx",   "bmax",     "boxmax", "aabbmax",   "maxp",  "upper", "pmax",
                   "b1", "bounds1", "maximum", "vmax", "maxbound", "h",      "maxcorner", "bbmax", "rt",    "box1"});

    // Planes and discs
    if (key.name == "normal") return is_one_of(name, {"n", "normal", "nor", "norm"});
    if (key.name == "through") return is_one_of(name, {"p", "p0", "point", "q", "pos", "center", "origin"});

    // The vertices of a triangle have a number or a letter.
    if (shape == Shape::triangle) {
        const std::string digit = std::to_string(k), letter(1, static_cast<char>('a' + k));
        for (const char* const stem : {"v", "p", "vert", "vertex", "tri", "verts", "pts", "points", "t", "vertices"})
            if (name == stem + digit) return true;
        return name == letter || name == "v" + letter;
    }
    return name == key.short_name;
}

/// Returns the shape whose name, or another usual word for it, is part of the text. `text` is normalized.
inline std::optional<Shape> find_shape(std::string_view text) {
    struct ShapeWord {
        std::string_view word;
        Shape shape;
    };
    constexpr std::array shape_words{ShapeWord{"sphere", Shape::sphere},     ShapeWord{"ball", Shape::sphere},
                                     ShapeWord{"aabb", Shape::box},          ShapeWord{"box", Shape::box},
                                     ShapeWord{"slab", Shape::box},          ShapeWord{"bounds", Shape::box},
                                     ShapeWord{"cube", Shape::box},          ShapeWord{"tri", Shape::triangle},
                                     ShapeWord{"moller", Shape::triangle},   ShapeWord{"ellipsoid", Shape::ellipsoid},
                                     ShapeWord{"cylinder", Shape::cylinder}, ShapeWord{"capsule", Shape::capsule},
                                     ShapeWord{"tube", Shape::tube},         ShapeWord{"cone", Shape::cone},
                                     ShapeWord{"disc", Shape::disc},         ShapeWord{"disk", Shape::disc},
                                     ShapeWord{"plane", Shape::plane},       ShapeWord{"torus", Shape::torus}};
    for (const ShapeWord& entry : shape_words)
        if (text.find(entry.word) != std::string_view::npos) return entry.shape;
    return {};
}

}  // namespace lostbits::intersect::function
