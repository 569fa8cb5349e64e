#include "intersect/function/signature.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <span>

#include "intersect/external/pipe_header.hpp"
#include "intersect/function/common_names.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect::function {
namespace {

using Kind = SourceType::Kind;

class PartLister {
public:
    std::vector<ArgumentPart> all;

    void add(const Argument& a, int index) {
        argument_names_ = normalise_name(a.name) + " " + normalise_name(a.target().name);
        const bool is_pointer = a.type.kind == Kind::pointer;
        argument_ = index;
        is_out_ = is_pointer && !a.type.is_const && !a.is_this && is_answer(a);
        const std::string name = a.is_this ? "this" : a.name;

        // A pointer to a number means one number if its name says so, and three otherwise; a reference means one.
        if (is_pointer && a.target().kind == Kind::number) {
            const bool is_single = a.type.name == "&" || is_out_ ||
                                   is_one_of(normalise_name(a.name), {"radius", "r", "tmin", "tmax", "t"});
            ArgumentPart& p = add_number(0, a.target().size, name, normalise_name(a.name));
            p.is_vector = !is_single;
            p.points_to_numbers = a.type.name != "&";
            return;
        }
        flatten(a.target(), 0, name, normalise_name(a.name));
    }

private:
    static bool is_answer(const Argument& a) {
        const std::string name = normalise_name(a.name), type = normalise_name(a.target().name);
        if (a.target().kind == Kind::number || a.target().kind == Kind::integer)
            return !is_one_of(
                name, {"o",   "d",   "org", "orig", "origin", "dir", "direction", "center", "centre", "c",
                       "ro",  "rd",  "v0",  "v1",   "v2",     "a",   "b",         "vert0",  "vert1",  "vert2",
                       "min", "max", "lo",  "hi",   "p0",     "p1",  "p2",        "pos",    "n",      "normal"});
        for (const char* const word : {"hit", "rec", "isect", "inter", "info", "result", "out", "answer", "si"})
            if (name.find(word) != std::string::npos || type.find(word) != std::string::npos) return true;
        return false;
    }

    ArgumentPart& add_number(std::size_t offset, std::size_t size, const std::string& path,
                             const std::string& last_name) {
        ArgumentPart p{.slot = {argument_, offset, size, false},
                       .path = path,
                       .last_name = last_name,
                       .argument_names = argument_names_};
        p.is_out = is_out_;
        return all.emplace_back(std::move(p));
    }
    ArgumentPart& add_vector(std::size_t offset, std::size_t size, const std::string& path,
                             const std::string& last_name) {
        ArgumentPart& p = add_number(offset, size, path, last_name);
        p.is_vector = true;
        return p;
    }

    /// Adds the vectors and numbers of a type. Numbers that follow one another are vectors where their count allows it.
    void flatten(const SourceType& type, std::size_t offset, const std::string& path, const std::string& last_name) {
        if (--parts_left_ < 0) return;
        std::size_t size = 0;
        std::string last_member;
        const int count = count_numbers(type, size, last_member);
        if (type.kind == Kind::number || type.kind == Kind::integer) {
            add_number(offset, type.size, path, last_name).slot.is_integer = type.kind == Kind::integer;
            return;
        }

        // Three or four numbers are a vector, unless they have names of their own. The fourth may be a radius.
        const bool is_sequence = is_sequence_of_numbers(type);
        if (is_sequence && (count == 3 || (count == 4 && !is_radius_name(last_member)))) {
            const bool has_own_names =
                type.kind == Kind::structure && type.parts.size() >= 3 && type.parts[0].kind == Kind::number &&
                is_one_of(normalise_name(type.parts[0].member), {"t", "tmin", "tnear", "near", "dist", "radius"});
            if (!has_own_names) {
                add_vector(offset, size, path, last_name).has_fourth = count == 4;
                return;
            }
        }
        if (is_sequence && count == 4) {
            add_vector(offset, size, path + "." + type.parts[0].member, "centre");
            add_number(offset + 3 * size, size, path + "." + last_member, "radius");
            return;
        }

        // An array of numbers may be several vectors.
        if (type.kind == Kind::sequence && count > 0 && count % 3 == 0 && type.parts[0].kind == Kind::number) {
            for (int k = 0; k < count / 3; ++k)
                add_vector(offset + static_cast<std::size_t>(3 * k) * size, size,
                           path + "[" + std::to_string(3 * k) + "]", last_name + std::to_string(k));
            return;
        }

        // Other arrays and structures part by part.
        if (type.kind == Kind::sequence && type.count <= 16) {
            for (std::size_t k = 0; k < type.count; ++k)
                flatten(type.parts[0], offset + k * type.parts[0].size, path + "[" + std::to_string(k) + "]",
                        last_name + std::to_string(k));
            return;
        }
        if (type.kind == Kind::structure)
            for (const SourceType& p : type.parts) {
                const std::string name = p.member.starts_with("__") ? p.member.substr(2) : p.member;
                flatten(p, offset + p.offset, name.empty() ? path : path + "." + name,
                        name.empty() ? last_name : normalise_name(name));
            }
    }

    std::string argument_names_;
    int argument_ = 0, parts_left_ = 2000;  ///< limit: arrays of arrays may have more parts than memory holds
    bool is_out_ = false;
};

}  // namespace

std::vector<ArgumentPart> list_parts(const std::vector<Argument>& arguments) {
    PartLister parts;
    for (std::size_t k = 0; k < arguments.size(); ++k) parts.add(arguments[k], static_cast<int>(k));
    return parts.all;
}

bool is_answer_role(const std::string& role) { return is_one_of(role, {"t", "far", "hit"}); }

bool has_role(const std::vector<ArgumentPart>& parts, const std::string& role) {
    return std::ranges::find(parts, role, &ArgumentPart::role) != parts.end();
}

ArgumentPart fourth_number_of(ArgumentPart vector) {
    vector.slot.offset += 3 * vector.slot.size;
    vector.is_vector = vector.has_fourth = false;
    vector.path += ".w";
    vector.role = "";
    return vector;
}

namespace {

bool is_tmin(const ArgumentPart& part) {
    return !part.is_vector && (is_tmin_name(part.last_name) || part.last_name == "min");
}
bool is_tmax(const ArgumentPart& part) {
    return !part.is_vector && (is_tmax_name(part.last_name) || part.last_name == "max");
}

Shape guess_shape(const UserSignature& signature, const StatedSignature& stated, const std::vector<ArgumentPart>& parts,
                  const std::string& message_prefix) {
    // The shape that is stated, or that the names of the function or its arguments contain.
    if (!stated.shape.empty()) return stated_shape(stated);
    if (const auto named = find_shape(normalise_name(signature.call))) return *named;
    for (const Argument& a : signature.arguments)
        if (const auto named = find_shape(normalise_name(a.target().name) + " " + normalise_name(a.name)))
            return *named;

    // The only shape with so many vectors and numbers beside the origin and the direction.
    std::size_t vector_count = 0, number_count = 0;
    bool has_fourth = false;
    for (const ArgumentPart& part : parts) {
        has_fourth = has_fourth || part.has_fourth;
        if (part.is_out || part.slot.is_integer || is_tmin(part) || is_tmax(part) ||
            is_inverse_direction_name(part.last_name))
            continue;
        ++(part.is_vector ? vector_count : number_count);
    }
    if (vector_count == 3 && (number_count == 1 || (number_count == 0 && has_fourth))) return Shape::sphere;
    if (vector_count == 4 && number_count == 0) return Shape::box;
    if (vector_count == 5 && number_count == 0) return Shape::triangle;
    throw InputError(message_prefix +
                     ": cannot tell from its name and its arguments which primitive it intersects; add a comment such "
                     "as // lostbits: sphere(o, d, c, r)");
}

/// Gives each part a role: o, d, 1/d, tmin, tmax, or k followed by the index of the key.
class RoleGuesser {
public:
    RoleGuesser(std::vector<ArgumentPart>& parts, Shape shape)
        : parts_(parts), shape_(shape), keys_(row_of(shape).keys) {}

    void guess() {
        guess_ray_by_names();
        guess_ray_by_order();
        guess_keys();
        split_fourth_numbers();
    }

private:
    void set_role(ArgumentPart& part, const std::string& role) const {
        if (part.role.empty() && !has_role(parts_, role)) part.role = role;
    }
    static bool is_in_ray(const ArgumentPart& part) { return part.argument_names.find("ray") != std::string::npos; }
    [[nodiscard]] bool may_be_key(const ArgumentPart& part, const Key& key) const {
        return part.role.empty() && !part.is_out && !part.slot.is_integer && part.is_vector == (key.count() == 3);
    }

    void guess_ray_by_names() {
        for (ArgumentPart& part : parts_) {
            if (part.is_out || part.slot.is_integer) continue;
            const bool in_ray = is_in_ray(part);
            const bool is_whole_argument = part.path.find_first_of(".[") == std::string::npos;
            if (part.is_vector && (in_ray || is_whole_argument)) {
                if (is_inverse_direction_name(part.last_name)) set_role(part, "1/d");
                else if (in_ray && !is_whole_argument && is_origin_name(part.last_name)) set_role(part, "o");
                else if (in_ray && !is_whole_argument && is_direction_name(part.last_name)) set_role(part, "d");
                else if (is_whole_argument && !is_one_of(part.last_name, {"a", "b", "p0", "pos", "e", "v"})) {
                    if (is_origin_name(part.last_name)) set_role(part, "o");
                    else if (is_direction_name(part.last_name)) set_role(part, "d");
                }
            } else if (is_tmin(part) || is_tmax(part)) {
                set_role(part, is_tmin(part) ? "tmin" : "tmax");
            }
        }
    }

    /// Gives the origin and the direction to the first vectors that are left: first to those inside of a ray.
    void guess_ray_by_order() {
        for (const char* const role : {"o", "d"}) {
            if (has_role(parts_, role) || (std::string_view(role) == "d" && has_role(parts_, "1/d"))) continue;
            for (const bool ray_only : {true, false}) {
                if (has_role(parts_, role)) break;
                for (ArgumentPart& part : parts_) {
                    const bool in_ray = is_in_ray(part);
                    const bool is_whole_argument = part.path.find('.') == std::string::npos;
                    if (!part.is_vector || part.is_out || !part.role.empty() ||
                        !(ray_only ? in_ray && !is_whole_argument : is_whole_argument || in_ray))
                        continue;
                    part.role = role;
                    break;
                }
            }
        }
    }

    /// Gives the keys of the primitive to parts with a common name of the key, then to the parts that are left.
    void guess_keys() {
        for (ArgumentPart& part : parts_)
            for (std::size_t k = 0; k < keys_.size(); ++k)
                if (may_be_key(part, keys_[k]) && is_common_name_of_key(part.last_name, keys_[k], k, shape_))
                    set_role(part, key_role(k));
        for (std::size_t k = 0; k < keys_.size(); ++k) {
            // A number is an inner radius only if its name says so: more often it is an epsilon.
            if (has_role(parts_, key_role(k)) || keys_[k].name == "inner_radius") continue;
            const auto p =
                std::ranges::find_if(parts_, [&](const ArgumentPart& part) { return may_be_key(part, keys_[k]); });
            if (p != parts_.end()) p->role = key_role(k);
        }
    }

    /// Makes the fourth number of `vec4 sphere` of shaders the radius, if no part is the radius.
    void split_fourth_numbers() {
        for (std::size_t k = 1; k < keys_.size(); ++k) {
            const auto previous_key = std::ranges::find(parts_, key_role(k - 1), &ArgumentPart::role);
            if (has_role(parts_, key_role(k)) || keys_[k].count() != 1 || previous_key == parts_.end() ||
                !previous_key->has_fourth)
                continue;
            ArgumentPart fourth = fourth_number_of(*previous_key);
            fourth.role = key_role(k);
            parts_.push_back(std::move(fourth));
        }
    }

    std::vector<ArgumentPart>& parts_;
    Shape shape_;
    std::span<const Key> keys_;
};

/// Finds the slots of hit, t and the far t among the numbers that a function writes or returns.
void find_output_slots(UserSignature& signature, const std::vector<ArgumentPart>& parts) {
    for (const ArgumentPart& part : parts) {
        if (part.is_vector) continue;
        if (part.slot.is_integer) {
            if (!signature.hit && (is_hit_name(part.last_name) || part.role == "hit")) signature.hit = part.slot;
        } else if (!signature.t && (is_t_name(part.last_name) || part.role == "t")) {
            signature.t = part.slot;
        } else if (!signature.far && (is_far_name(part.last_name) || part.role == "far")) {
            signature.far = part.slot;
        }
    }
}

std::string role_text(Shape shape, const std::string& role) {
    if (role == "o") return "origin";
    if (role == "d") return "direction";
    if (role == "1/d") return "1/direction";
    if (role[0] == 'k') return std::string(row_of(shape).keys[key_index(role)].name);
    return role;
}

/// Turns a float* without const and without a role as an input into an output. Many C functions take their input arrays
/// without const, so this comes last.
void find_output_arrays(std::vector<ArgumentPart>& parts, const UserSignature& signature) {
    for (ArgumentPart& part : parts) {
        const bool is_const = signature.arguments[part.slot.argument].type.is_const;
        if (!part.role.empty() || !part.points_to_numbers || !part.is_vector || is_const) continue;
        part.is_vector = false;
        part.is_out = true;
    }
}

/// Throws InputError, with a comment to write, if a part of the ray or of the primitive has no argument.
void require_inputs(const std::vector<ArgumentPart>& parts, Shape shape, const std::string& message_prefix) {
    const auto keys = row_of(shape).keys;
    std::string missing_roles;
    const auto add_missing = [&missing_roles](const std::string& role) {
        missing_roles += (missing_roles.empty() ? "" : ", ") + role;
    };
    if (!has_role(parts, "o")) add_missing("the origin of the ray");
    if (!has_role(parts, "d") && !has_role(parts, "1/d")) add_missing("the direction of the ray");
    for (std::size_t k = 0; k < keys.size(); ++k)
        if (!has_role(parts, key_role(k)) && !keys[k].is_optional)
            add_missing("`" + std::string(keys[k].name) + "` of the " + std::string(name_of(shape)));
    if (missing_roles.empty()) return;

    std::string example = std::string(name_of(shape)) + "(o, d";
    for (const Key& key : keys) example += ", " + std::string(key.name);
    throw InputError(message_prefix + ": no argument was found for " + missing_roles +
                     "; name the arguments in a comment of the file, such as // lostbits: " + example + ")");
}

/// Adds the numbers that a part receives: those of its role, in the order origin, direction, keys, end of the ray.
void add_inputs(UserSignature& signature, const ArgumentPart& part, Shape shape) {
    if (part.role.empty() || part.role == "-" || is_answer_role(part.role)) return;
    constexpr std::size_t first_direction = 3, first_key = 6;
    const auto keys = row_of(shape).keys;
    std::size_t input_index = part.role == "o"                         ? 0
                              : part.role == "d" || part.role == "1/d" ? first_direction
                                                                       : first_key;
    if (part.role[0] == 'k')
        for (std::size_t k = 0; k < key_index(part.role); ++k) input_index += keys[k].count();
    if (part.role == "tmax") input_index = first_key + row_of(shape).number_count;

    if (part.component > 0) input_index += static_cast<std::size_t>(part.component);
    for (std::size_t k = 0; k < (part.is_vector ? 3U : 1U); ++k) {
        const std::string input = "in[" + std::to_string(input_index + k) + "]";
        NumberSlot slot = part.components.empty() ? part.slot : part.components[k];
        if (part.components.empty()) slot.offset += k * part.slot.size;
        signature.inputs.push_back({slot, part.role == "1/d" ? "1 / " + input : part.role == "tmin" ? "0" : input});
    }
    signature.text += (signature.text.empty() ? "" : ", ") + role_text(shape, part.role) +
                      (part.component < 0 ? "" : std::string(".") + "xyz"[part.component]) + " = " + part.path;
}

/// Sets the slots of the answers: in the returned value first, then in the outputs. Returns the parts of the returned
/// value if it is a structure.
std::vector<ArgumentPart> find_answers(UserSignature& signature, const std::vector<ArgumentPart>& parts) {
    const SourceType* value = &signature.returned;
    if (value->kind == Kind::optional && !value->parts.empty()) {
        signature.hit_is_optional = true;
        value = &value->parts[0];
    }
    std::vector<ArgumentPart> returned_parts;
    if (value->kind == Kind::number) {
        signature.t = NumberSlot{-1, 0, value->size, false};
    } else if (value->kind == Kind::integer) {
        signature.hit = NumberSlot{-1, 0, value->size, true};
    } else if (value->kind == Kind::structure) {
        // Three numbers x, y, z are t and coordinates inside of a triangle.
        const bool is_vector = value->parts.size() > 2 && normalise_name(value->parts[1].member) == "y";
        for (const SourceType& type : std::span(value->parts).first(is_vector ? 1 : value->parts.size())) {
            if (type.kind != Kind::number && type.kind != Kind::integer) continue;
            const std::string last =
                normalise_name(type.member.starts_with("__") ? type.member.substr(2) : type.member);
            returned_parts.push_back({.slot = {-1, type.offset, type.size, type.kind == Kind::integer},
                                      .path = type.member,
                                      .last_name = last});
        }
        find_output_slots(signature, returned_parts);
    }

    std::vector<ArgumentPart> output_parts;
    std::ranges::copy_if(parts, std::back_inserter(output_parts), &ArgumentPart::is_out);
    find_output_slots(signature, output_parts);
    // If no name says that an output is t, it is the first number that the function writes.
    for (const ArgumentPart& part : output_parts)
        if (!part.is_vector && !part.slot.is_integer && !signature.t && part.path.find('.') == std::string::npos)
            signature.t = part.slot;
    return returned_parts;
}

/// Sets the properties of the contract that follow from the signature.
void set_contract(UserSignature& signature, Shape shape, bool takes_tmax) {
    external::Contract& c = signature.contract;
    c.shape = shape;
    c.bits = signature.bits;
    c.roots = signature.t && signature.far ? Roots::both : signature.t ? Roots::first_only : Roots::none;
    if (row_of(shape).takes_tmax && !takes_tmax && c.roots != Roots::none) c.flags |= LB_NO_END;
}

/// Describes where the answers are, for the user.
std::string answers_text(const UserSignature& signature, const std::vector<ArgumentPart>& parts,
                         const std::vector<ArgumentPart>& returned_parts) {
    const auto source_of = [&](const NumberSlot& slot) -> std::string {
        if (slot.argument < 0) {
            for (const ArgumentPart& part : returned_parts)
                if (part.slot.offset == slot.offset) return "its " + part.path;
            return "the result";
        }
        for (const ArgumentPart& part : parts)
            if (part.slot.argument == slot.argument && part.slot.offset == slot.offset) return part.path;
        return "an argument";
    };
    std::string text;
    if (signature.hit_is_optional) text = "hit where the result has a value";
    else if (signature.hit) text = "hit where " + source_of(*signature.hit) + " is not 0";
    if (signature.t) text += std::string(text.empty() ? "" : ", ") + "t = " + source_of(*signature.t);
    if (signature.far) text += ", far = " + source_of(*signature.far);
    return text;
}

}  // namespace

void guess_signature(UserSignature& signature, const StatedSignature& stated, const std::string& message_prefix) {
    // The role of each part of the arguments.
    std::vector<ArgumentPart> parts = list_parts(signature.arguments);
    if (!stated.has_roles) join_named_components(parts);
    const Shape shape = guess_shape(signature, stated, parts, message_prefix);
    if (stated.has_roles) apply_stated_roles(parts, shape, stated);
    else RoleGuesser(parts, shape).guess();
    find_output_arrays(parts, signature);
    require_inputs(parts, shape, message_prefix);

    // The inputs, and the format in which the function computes.
    signature.bits = 64;
    for (const ArgumentPart& part : parts)
        if (!part.is_out && !part.slot.is_integer && part.slot.size == 4) signature.bits = 32;
    for (const ArgumentPart& part : parts) add_inputs(signature, part, shape);
    signature.text = std::string(name_of(shape)) + ": " + signature.text;

    // The answers.
    const std::vector<ArgumentPart> returned_parts = find_answers(signature, parts);
    if (!signature.hit && !signature.t && !signature.hit_is_optional)
        throw InputError(message_prefix +
                         ": neither its result nor an argument seems to be t or a hit flag; return t or bool, or "
                         "name the argument that receives t in a comment of the file, such as // lostbits: " +
                         std::string(name_of(shape)) + "(o, d, ..., t)");

    set_contract(signature, shape, has_role(parts, "tmax"));
    for (const auto& [key, text] : stated.properties)
        apply_stated_property(signature, key, text, stated.message_prefix);
    const bool has_hit = signature.hit || signature.hit_is_optional;
    if (has_hit && signature.miss_value.kind == MissValue::Kind::unknown)
        signature.miss_value.kind = MissValue::Kind::none;
    signature.text += "; " + answers_text(signature, parts, returned_parts);
}

}  // namespace lostbits::intersect::function
