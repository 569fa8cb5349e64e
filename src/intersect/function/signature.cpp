#include "intersect/function/signature.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>

#include "intersect/external/pipe_header.hpp"
#include "intersect/function/common_names.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect::function {
namespace {

using Kind = SourceType::Kind;

/// A vector or a number of an argument, and the names from which its role is guessed.
struct Part {
    Slot slot;
    bool is_vector = false;
    std::string path;                 ///< expression in the source: "ray.origin"
    std::string last_name;            ///< the last name of the path, normalized
    std::string argument_names = {};  ///< normalized names of the argument and its type
    bool is_out = false;              ///< true if the function writes the part
    bool points_to_numbers = false;   ///< argument of type float*, which may be one number or three
    bool has_fourth = false;          ///< a vector of four numbers, whose last one may be a radius
    std::string role = {};            ///< see `guess_roles`; empty while unknown
};

bool is_tmin(const Part& p) { return !p.is_vector && (is_tmin_name(p.last_name) || p.last_name == "min"); }
bool is_tmax(const Part& p) { return !p.is_vector && (is_tmax_name(p.last_name) || p.last_name == "max"); }

class Parts {
public:
    std::vector<Part> all;

    void add(const Argument& a, int index) {
        argument_names_ = normalized_name(a.name) + " " + normalized_name(a.target().name);
        const bool is_pointer = a.type.kind == Kind::pointer;
        argument_ = index;
        is_out_ = is_pointer && !a.type.is_const && !a.is_this && is_answer(a);
        const std::string name = a.is_this ? "this" : a.name;
        // A pointer to a number means one number if its name says so, and three otherwise; a reference means one.
        if (is_pointer && a.target().kind == Kind::number) {
            const bool is_single = a.type.name == "&" || is_out_ ||
                                   is_one_of(normalized_name(a.name), {"radius", "r", "tmin", "tmax", "t"});
            add_part(0, a.target().size, !is_single, name, normalized_name(a.name));
            all.back().points_to_numbers = a.type.name != "&";
            return;
        }
        flatten(a.target(), 0, name, normalized_name(a.name));
    }

private:
    static bool is_answer(const Argument& a) {
        const std::string name = normalized_name(a.name), type = normalized_name(a.target().name);
        if (a.target().kind == Kind::number || a.target().kind == Kind::integer)
            return !is_one_of(
                name, {"o",   "d",   "org", "orig", "origin", "dir", "direction", "center", "centre", "c",
                       "ro",  "rd",  "v0",  "v1",   "v2",     "a",   "b",         "vert0",  "vert1",  "vert2",
                       "min", "max", "lo",  "hi",   "p0",     "p1",  "p2",        "pos",    "n",      "normal"});
        for (const char* const word : {"hit", "rec", "isect", "inter", "info", "result", "out", "answer", "si"})
            if (name.find(word) != std::string::npos || type.find(word) != std::string::npos) return true;
        return false;
    }

    void add_part(std::size_t offset, std::size_t size, bool is_vector, const std::string& path,
                  const std::string& last_name, bool is_integer = false) {
        Part p{.slot = {argument_, offset, size, is_integer},
               .is_vector = is_vector,
               .path = path,
               .last_name = last_name,
               .argument_names = argument_names_};
        p.is_out = is_out_;
        all.push_back(std::move(p));
    }

    void flatten(const SourceType& t, std::size_t offset, const std::string& path, const std::string& last_name) {
        if (--parts_left_ < 0) return;
        std::size_t size = 0;
        std::string last_member;
        const int count = count_numbers(t, size, last_member);
        if (t.kind == Kind::number) return add_part(offset, t.size, false, path, last_name);
        if (t.kind == Kind::integer) return add_part(offset, t.size, false, path, last_name, true);
        const bool is_sequence = is_sequence_of_numbers(t);
        if (is_sequence && (count == 3 || (count == 4 && !is_radius_name(last_member)))) {
            // Three numbers with names of their own are not a vector.
            const bool has_own_names =
                t.kind == Kind::structure && t.parts.size() >= 3 && t.parts[0].kind == Kind::number &&
                is_one_of(normalized_name(t.parts[0].member), {"t", "tmin", "tnear", "near", "dist", "radius"});
            if (!has_own_names) {
                add_part(offset, size, true, path, last_name);
                all.back().has_fourth = count == 4;
                return;
            }
        }
        if (is_sequence && count == 4) {
            add_part(offset, size, true, path + "." + t.parts[0].member, "centre");
            return add_part(offset + 3 * size, size, false, path + "." + last_member, "radius");
        }
        if (t.kind == Kind::sequence && count > 0 && count % 3 == 0 && t.parts[0].kind == Kind::number) {
            for (int k = 0; k < count / 3; ++k) {
                const std::string index = std::to_string(k);
                add_part(offset + static_cast<std::size_t>(3 * k) * size, size, true,
                         path + "[" + std::to_string(3 * k) + "]", last_name + index);
            }
            return;
        }
        if (t.kind == Kind::sequence && t.count <= 16) {
            for (std::size_t k = 0; k < t.count; ++k)
                flatten(t.parts[0], offset + k * t.parts[0].size, path + "[" + std::to_string(k) + "]",
                        last_name + std::to_string(k));
            return;
        }
        if (t.kind == Kind::structure)
            for (const SourceType& p : t.parts) {
                const std::string name = p.member.starts_with("__") ? p.member.substr(2) : p.member;
                flatten(p, offset + p.offset, name.empty() ? path : path + "." + name,
                        name.empty() ? last_name : normalized_name(name));
            }
    }

    std::string argument_names_;
    int argument_ = 0, parts_left_ = 2000;  ///< limit: arrays of arrays may have more parts than memory holds
    bool is_out_ = false;
};

Shape guess_shape(const UserSignature& signature, const StatedSignature& stated, const std::vector<Part>& parts,
                  const std::string& subject) {
    if (!stated.shape.empty()) {
        const auto shape_name = std::ranges::find(shape_names, std::string_view(stated.shape));
        if (shape_name == shape_names.end() || *shape_name == "sdf") {
            std::string all_names;
            for (const std::string_view name : shape_names)
                if (name != "sdf") all_names += (all_names.empty() ? "" : ", ") + std::string(name);
            throw InputError(stated.where + ": " + external::quote_text(stated.shape) + " is not one of " + all_names);
        }
        return static_cast<Shape>(shape_name - shape_names.begin());
    }
    if (const auto named = find_shape(normalized_name(signature.call))) return *named;
    for (const Argument& a : signature.arguments)
        if (const auto named = find_shape(normalized_name(a.target().name) + " " + normalized_name(a.name)))
            return *named;
    std::size_t vectors = 0, numbers = 0;
    bool has_fourth = false;
    for (const Part& p : parts) {
        has_fourth = has_fourth || p.has_fourth;
        if (p.is_out || p.slot.is_integer || is_tmin(p) || is_tmax(p) || is_inverse_direction_name(p.last_name))
            continue;
        ++(p.is_vector ? vectors : numbers);
    }
    if (vectors == 3 && (numbers == 1 || (numbers == 0 && has_fourth))) return Shape::sphere;
    if (vectors == 4 && numbers == 0) return Shape::box;
    if (vectors == 5 && numbers == 0) return Shape::triangle;
    throw InputError(subject +
                     ": its name and its arguments do not say which primitive it intersects; say it in a comment "
                     "of the file, such as // lostbits: sphere(o, d, c, r)");
}

/// Returns the last number of a vector of four numbers as a part of its own.
Part fourth_number_of(Part vector) {
    vector.slot.offset += 3 * vector.slot.size;
    vector.is_vector = vector.has_fourth = false, vector.path += ".w", vector.role = "";
    return vector;
}

/// Gives each part a role: o, d, 1/d, tmin, tmax, or k followed by the index of the key.
void guess_roles(std::vector<Part>& parts, Shape shape) {
    const auto keys = row_of(shape).keys;
    const auto has_role = [&](const std::string& role) {
        return std::ranges::find(parts, role, &Part::role) != parts.end();
    };
    const auto set_role = [&](Part& p, const std::string& role) {
        if (p.role.empty() && !has_role(role)) p.role = role;
    };
    for (Part& p : parts) {
        if (p.is_out || p.slot.is_integer) continue;
        const bool in_ray = p.argument_names.find("ray") != std::string::npos;
        const bool is_whole_argument = p.path.find('.') == std::string::npos && p.path.find('[') == std::string::npos;
        const bool may_be_ray = in_ray || is_whole_argument;
        if (p.is_vector && may_be_ray) {
            if (is_inverse_direction_name(p.last_name)) set_role(p, "1/d");
            else if (in_ray && !is_whole_argument && is_origin_name(p.last_name)) set_role(p, "o");
            else if (in_ray && !is_whole_argument && is_direction_name(p.last_name)) set_role(p, "d");
            else if (is_whole_argument && !is_one_of(p.last_name, {"a", "b", "p0", "pos", "e", "v"})) {
                if (is_origin_name(p.last_name)) set_role(p, "o");
                else if (is_direction_name(p.last_name)) set_role(p, "d");
            }
        } else if (is_tmin(p)) {
            set_role(p, "tmin");
        } else if (is_tmax(p)) {
            set_role(p, "tmax");
        }
    }
    // Arguments whose names give no role get roles in the usual order.
    for (const char* const role : {"o", "d"}) {
        if (has_role(role) || (std::string_view(role) == "d" && has_role("1/d"))) continue;
        for (const bool ray_only : {true, false}) {
            if (has_role(role)) break;
            for (Part& p : parts) {
                const bool in_ray = p.argument_names.find("ray") != std::string::npos;
                const bool is_whole_argument = p.path.find('.') == std::string::npos;
                if (!p.is_vector || p.is_out || !p.role.empty() ||
                    !(ray_only ? in_ray && !is_whole_argument : is_whole_argument || in_ray))
                    continue;
                p.role = role;
                break;
            }
        }
    }
    for (Part& p : parts) {
        if (p.is_out || p.slot.is_integer || !p.role.empty()) continue;
        for (std::size_t k = 0; k < keys.size(); ++k)
            if (p.is_vector == (keys[k].count() == 3) && is_common_name_of_key(p.last_name, keys[k], k, shape))
                set_role(p, "k" + std::to_string(k));
    }
    for (std::size_t k = 0; k < keys.size(); ++k) {
        const std::string role = "k" + std::to_string(k);
        // A number is an inner radius only if its name says so: more often it is an epsilon.
        if (has_role(role) || keys[k].name == "inner_radius") continue;
        for (Part& p : parts)
            if (p.role.empty() && !p.is_out && !p.slot.is_integer && p.is_vector == (keys[k].count() == 3)) {
                p.role = role;
                break;
            }
    }
    // `vec4 sphere` of shaders: the centre, and the radius as the fourth number.
    for (std::size_t k = 1; k < keys.size(); ++k) {
        const auto previous_key = std::ranges::find(parts, "k" + std::to_string(k - 1), &Part::role);
        if (has_role("k" + std::to_string(k)) || keys[k].count() != 1 || previous_key == parts.end() ||
            !previous_key->has_fourth)
            continue;
        Part fourth = fourth_number_of(*previous_key);
        fourth.role = "k" + std::to_string(k);
        parts.push_back(std::move(fourth));
    }
}

/// Gives the parts the roles that a comment states, in the order of the arguments.
void apply_stated_roles(std::vector<Part>& parts, Shape shape, const StatedSignature& stated) {
    const auto keys = row_of(shape).keys;
    for (std::size_t k = 0; k < parts.size(); ++k)
        if (parts[k].has_fourth && stated.roles.size() > parts.size())
            parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(k) + 1, fourth_number_of(parts[k]));
    std::vector<Part*> open_parts;
    for (Part& p : parts) open_parts.push_back(&p);
    if (stated.roles.size() > open_parts.size())
        throw InputError(stated.where + ": names " + std::to_string(stated.roles.size()) +
                         " arguments, but the function "
                         "takes " +
                         std::to_string(open_parts.size()) + " vectors and numbers");
    for (std::size_t i = 0; i < stated.roles.size(); ++i) {
        const std::string role_name = normalized_name(stated.roles[i]);
        std::string role;
        for (std::size_t k = 0; k < keys.size() && role.empty(); ++k)
            if (role_name == keys[k].name || role_name == keys[k].short_name) role = "k" + std::to_string(k);
        if (role_name == "-" || role_name.empty()) role = "-";
        else if (is_one_of(role_name, {"o", "d", "1/d", "tmin", "tmax", "t", "far", "hit"})) role = role_name;
        else if (is_one_of(role_name, {"origin", "direction"})) role = role_name.substr(0, 1);
        for (std::size_t k = 0; k < keys.size() && role.empty(); ++k)
            if (is_common_name_of_key(role_name, keys[k], k, shape)) role = "k" + std::to_string(k);
        if (role.empty())
            throw InputError(stated.where + ": " + external::quote_text(stated.roles[i]) +
                             " is not one of o, d, 1/d, tmin, "
                             "tmax, t, far, hit, -, or a part of " +
                             with_article(shape) + ": " + key_list(shape));
        open_parts[i]->role = role;
        open_parts[i]->is_out = is_one_of(role, {"t", "far", "hit", "-"}) && (open_parts[i]->is_out || role != "-");
        const bool is_number = is_one_of(role, {"t", "far", "hit", "tmin", "tmax"}) ||
                               (role[0] == 'k' && keys[static_cast<std::size_t>(role[1] - '0')].count() == 1);
        if (open_parts[i]->points_to_numbers && role != "-") open_parts[i]->is_vector = !is_number;
    }
}

/// Finds the slots of hit, t and the far t among the numbers that a function writes or returns.
void find_output_slots(UserSignature& signature, const std::vector<Part>& parts) {
    for (const Part& p : parts) {
        if (p.is_vector) continue;
        if (p.slot.is_integer) {
            if (!signature.hit && (is_hit_name(p.last_name) || p.role == "hit")) signature.hit = p.slot;
        } else if (!signature.t && (is_t_name(p.last_name) || p.role == "t")) {
            signature.t = p.slot;
        } else if (!signature.far && (is_far_name(p.last_name) || p.role == "far")) {
            signature.far = p.slot;
        }
    }
}

std::string role_text(Shape shape, const std::string& role) {
    if (role == "o") return "origin";
    if (role == "d") return "direction";
    if (role == "1/d") return "1/direction";
    if (role[0] == 'k') return std::string(row_of(shape).keys[static_cast<std::size_t>(role[1] - '0')].name);
    return role;
}

}  // namespace

void guess_signature(UserSignature& signature, const StatedSignature& stated, const std::string& subject) {
    Parts parts;
    for (std::size_t k = 0; k < signature.arguments.size(); ++k) parts.add(signature.arguments[k], static_cast<int>(k));
    const Shape shape = guess_shape(signature, stated, parts.all, subject);
    if (stated.has_roles) apply_stated_roles(parts.all, shape, stated);
    else guess_roles(parts.all, shape);
    // Many C functions take their input arrays without const, so a float* counts as an output only if it has no role as
    // an input.
    for (Part& p : parts.all)
        if (p.role.empty() && p.points_to_numbers && p.is_vector &&
            !signature.arguments[static_cast<std::size_t>(p.slot.argument)].type.is_const)
            p.is_vector = false, p.is_out = true;
    const auto keys = row_of(shape).keys;
    const std::size_t numbers = row_of(shape).numbers;
    signature.bits = 64;
    for (const Part& p : parts.all)
        if (!p.is_out && !p.slot.is_integer && p.slot.size == 4) signature.bits = 32;
    std::string missing_roles;
    const auto has_role = [&](const std::string& role) {
        return std::ranges::find(parts.all, role, &Part::role) != parts.all.end();
    };
    const auto add_missing = [&missing_roles](const std::string& role) {
        missing_roles += (missing_roles.empty() ? "" : ", ") + role;
    };
    if (!has_role("o")) add_missing("the origin of the ray");
    if (!has_role("d") && !has_role("1/d")) add_missing("the direction of the ray");
    for (std::size_t k = 0; k < keys.size(); ++k)
        if (!has_role("k" + std::to_string(k)) && !keys[k].is_optional)
            add_missing("`" + std::string(keys[k].name) + "` of the " + std::string(name_of(shape)));
    if (!missing_roles.empty()) {
        std::string example = std::string(name_of(shape)) + "(o, d";
        for (const Key& key : keys) example += ", " + std::string(key.name);
        throw InputError(subject + ": no argument was found for " + missing_roles +
                         "; name the arguments in a comment of the file, such as // lostbits: " + example + ")");
    }
    for (const Part& p : parts.all) {
        if (p.role.empty() || p.role == "-" || is_one_of(p.role, {"t", "far", "hit"})) continue;
        std::size_t input_index = p.role == "o" ? 0 : p.role == "d" || p.role == "1/d" ? 3 : 6;
        if (p.role[0] == 'k')
            for (std::size_t k = 0; k < static_cast<std::size_t>(p.role[1] - '0'); ++k) input_index += keys[k].count();
        if (p.role == "tmax") input_index = 6 + numbers;
        for (std::size_t k = 0; k < (p.is_vector ? 3U : 1U); ++k) {
            const std::string input = "in[" + std::to_string(input_index + k) + "]";
            Slot slot = p.slot;
            slot.offset += k * p.slot.size;
            signature.inputs.push_back({slot, p.role == "1/d" ? "1 / " + input : p.role == "tmin" ? "0" : input});
        }
        signature.text += (signature.text.empty() ? "" : ", ") + role_text(shape, p.role) + " = " + p.path;
    }
    signature.text = std::string(name_of(shape)) + ": " + signature.text;

    // Answers
    std::vector<Part> output_parts;
    for (const Part& p : parts.all)
        if (p.is_out) output_parts.push_back(p);
    const SourceType* value = &signature.returned;
    if (value->kind == Kind::optional && !value->parts.empty()) {
        signature.hit_is_optional = true;
        value = &value->parts[0];
    }
    std::vector<Part> returned_parts;
    if (value->kind == Kind::number) {
        signature.t = Slot{-1, 0, value->size, false};
    } else if (value->kind == Kind::integer) {
        signature.hit = Slot{-1, 0, value->size, true};
    } else if (value->kind == Kind::structure) {
        // Three numbers x, y, z are t and coordinates inside of a triangle.
        const bool is_vector = value->parts.size() > 2 && normalized_name(value->parts[1].member) == "y";
        for (const SourceType& p : std::span(value->parts).first(is_vector ? 1 : value->parts.size())) {
            if (p.kind != Kind::number && p.kind != Kind::integer) continue;
            const std::string last = normalized_name(p.member.starts_with("__") ? p.member.substr(2) : p.member);
            returned_parts.push_back(
                {.slot = {-1, p.offset, p.size, p.kind == Kind::integer}, .path = p.member, .last_name = last});
        }
        find_output_slots(signature, returned_parts);
    }
    find_output_slots(signature, output_parts);
    if (!signature.t)  // any number that the function writes, whatever its name
        for (const Part& p : output_parts)
            if (!p.is_vector && !p.slot.is_integer && !signature.t && (p.path.find('.') == std::string::npos))
                signature.t = p.slot;
    if (!signature.hit && !signature.t && !signature.hit_is_optional)
        throw InputError(subject +
                         ": neither its result nor an argument seems to be t or a hit flag; return t or bool, or "
                         "name the argument that receives t in a comment of the file, such as // lostbits: " +
                         std::string(name_of(shape)) + "(o, d, ..., t)");
    external::Contract& c = signature.contract;
    c.shape = shape;
    c.bits = signature.bits;
    c.roots = signature.t && signature.far ? Roots::both : signature.t ? Roots::first_only : Roots::none;
    if (row_of(shape).takes_tmax && !has_role("tmax") && c.roots != Roots::none) c.flags |= LB_NO_END;
    for (const auto& [key, text] : stated.properties) {
        if (key == "name" || key == "format" || key == "function") continue;  // of comments for --shader
        if (key == "miss") {
            if (text == "inf" || text == "infinite") signature.miss_value.kind = MissValue::Kind::infinite;
            else if (text == "nan") signature.miss_value.kind = MissValue::Kind::nan;
            else if (text == "negative" || text.starts_with('-')) signature.miss_value.kind = MissValue::Kind::negative;
            else if (text == "0" || text == "zero") signature.miss_value.kind = MissValue::Kind::zero;
            else if (text == "none") signature.miss_value.kind = MissValue::Kind::none;
            else if (text == "crossed") signature.miss_value.kind = MissValue::Kind::crossed;
            else {
                signature.miss_value.kind = MissValue::Kind::above;
                if (std::from_chars(text.data(), text.data() + text.size(), signature.miss_value.bound).ec !=
                    std::errc())
                    throw InputError(
                        stated.where + ": miss is " + external::quote_text(text) +
                        "; it must be -1, 0, inf, nan, crossed, none, or the number from which on t means a miss");
            }
        } else if (!external::set_property(c, key, text, stated.where)) {
            throw InputError(
                stated.where + ": unknown property " + external::quote_text(key) +
                "; known properties are miss, roots, direction, touching, at_origin, inside, facing and flags");
        }
    }
    if (signature.hit || signature.hit_is_optional) {
        if (signature.miss_value.kind == MissValue::Kind::unknown) signature.miss_value.kind = MissValue::Kind::none;
    }
    const auto source_of = [&](const Slot& slot) -> std::string {
        if (slot.argument < 0) {
            for (const Part& p : returned_parts)
                if (p.slot.offset == slot.offset) return "its " + p.path;
            return "the result";
        }
        for (const Part& p : parts.all)
            if (p.slot.argument == slot.argument && p.slot.offset == slot.offset) return p.path;
        return "an argument";
    };
    signature.text += "; ";
    if (signature.hit_is_optional) signature.text += "hit where the result has a value";
    else if (signature.hit) signature.text += "hit where " + source_of(*signature.hit) + " is not 0";
    if (signature.t)
        signature.text +=
            std::string(signature.hit || signature.hit_is_optional ? ", " : "") + "t = " + source_of(*signature.t);
    if (signature.far) signature.text += ", far = " + source_of(*signature.far);
}

}  // namespace lostbits::intersect::function
