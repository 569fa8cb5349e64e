#include "intersect/shader/signature.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>

namespace lostbits::intersect::shader {
namespace {

using Way = Parameter::Way;

enum class Role { origin, direction, inverse, lo, hi, centre, point, unknown };

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

/// What a name of a vec3 says of it.
Role role_of(const std::string& named) {
    const std::string name = lower(named);
    const auto has = [&name](std::initializer_list<std::string_view> parts) {
        return std::ranges::any_of(parts, [&](std::string_view part) { return name.find(part) != std::string::npos; });
    };
    const auto is = [&name](std::initializer_list<std::string_view> words) {
        return std::ranges::find(words, name) != words.end();
    };
    if (has({"inv", "rcp"})) return Role::inverse;
    if (has({"dir"}) || is({"rd", "d", "rdir", "v", "raydir"})) return Role::direction;
    if (has({"orig"}) || is({"ro", "o", "eye", "start", "p0", "e"})) return Role::origin;
    if (has({"cent"}) || is({"c", "ce", "pos", "sc", "sphere"})) return Role::centre;
    if (has({"min", "low"}) || is({"lo", "a", "lb", "bl", "p1"})) return Role::lo;
    if (has({"max", "upp", "hig"}) || is({"hi", "b", "rt", "ur", "p2"})) return Role::hi;
    return Role::unknown;
}

const char* expression_of(Role role) {
    switch (role) {
        case Role::origin: return "lb_origin";
        case Role::direction: return "lb_direction";
        case Role::inverse: return "(1.0 / lb_direction)";
        case Role::lo: return "lb_lo";
        case Role::hi: return "lb_hi";
        case Role::centre: return "lb_centre";
        case Role::point: return "lb_point";
        case Role::unknown: break;
    }
    return "";
}

/// Roles in the order in which shader sites write them, replaced by what the names say where each is named once.
std::vector<Role> roles_of(const std::vector<const Parameter*>& vectors, std::vector<Role> usual) {
    std::vector<Role> named;
    for (const Parameter* p : vectors) {
        const Role role = role_of(p->name);
        named.push_back(role == Role::inverse ? Role::direction : role);
    }
    if (std::ranges::is_permutation(named, usual)) usual = named;
    for (std::size_t k = 0; k < vectors.size(); ++k) {
        if (usual[k] == Role::direction && role_of(vectors[k]->name) == Role::inverse) usual[k] = Role::inverse;
    }
    return usual;
}

bool contains_any(const std::string& name, std::initializer_list<std::string_view> parts) {
    return std::ranges::any_of(parts, [&](std::string_view part) { return name.find(part) != std::string::npos; });
}

/// Sorts the parameters of one function.
class Reader {
public:
    Reader(const Function& function, bool named) : named_(named) { found_.function = function; }

    std::optional<Signature> read() {
        const auto has_type = [&function = found_.function](std::initializer_list<std::string_view> types) {
            return std::ranges::any_of(function.parameters, [types](const Parameter& p) {
                return std::ranges::find(types, p.type) != types.end();
            });
        };
        found_.doubles = has_type({"dvec3", "dvec4", "double"});
        of_hlsl_ = has_type({"float3", "float4"});
        arguments_.resize(found_.function.parameters.size());
        for (std::size_t k = 0; k < arguments_.size(); ++k) {
            if (!sort(found_.function.parameters[k], k)) return {};
        }
        if (!take_kind() || !take_solid() || !take_answer()) return {};
        found_.arguments = std::move(arguments_);
        return std::move(found_);
    }

private:
    /// `vec3` as the function writes it: dvec3, float3.
    [[nodiscard]] std::string typed(const std::string& type) const {
        return of_hlsl_ ? "float" + type.substr(3) : (found_.doubles ? "d" : "") + type;
    }
    [[nodiscard]] std::string scalar() const { return found_.doubles ? "double" : "float"; }

    /// False for what an intersector does not take.
    bool sort(const Parameter& p, std::size_t k) {
        if (p.type.find('[') != std::string::npos || p.name.find('[') != std::string::npos) return false;
        if (p.way != Way::in) {
            arguments_[k] = "lb_out_" + std::to_string(k);
            if (p.type == scalar()) found_.outputs.push_back(arguments_[k]);
            found_.knows_end = found_.knows_end || (p.way == Way::inout && p.type == scalar());
            return true;
        }
        if (p.type == typed("vec3")) vectors_.push_back(k);
        else if (p.type == typed("vec4") && !whole_) whole_ = k;
        else if (p.type == scalar()) return take_number(p, k);
        else return false;
        return true;
    }

    /// A radius, or where the ray begins or ends.
    bool take_number(const Parameter& p, std::size_t k) {
        const std::string name = lower(p.name);
        const auto has = [&name](const char* part) { return name.find(part) != std::string::npos; };
        if (has("min") || has("start")) arguments_[k] = scalar() + "(0.0)";
        else if (has("max") || has("end")) {
            arguments_[k] = "lb_end";
            found_.knows_end = true;
        } else if (radius_) return false;
        else {
            radius_ = k;
            arguments_[k] = "lb_solid[3]";
        }
        return true;
    }

    /// How many vectors are numbers of the solid, and so what the others are.
    bool take_kind() {
        using Kind = Signature::Kind;
        const std::size_t of_solid = whole_ ? 0 : radius_ ? 1 : 2, vectors = vectors_.size();
        const std::string name = lower(found_.function.name);
        const bool field_name = contains_any(name, {"map", "sdf", "scene", "field", "getdist"}) || name == "de";
        const bool march_name = contains_any(name, {"march", "trace", "cast"});
        const bool has_solid = whole_ || radius_ || vectors > 2;
        const bool from_point = vectors > 0 && role_of(found_.function.parameters[vectors_[0]].name) != Role::origin;
        if (has_solid && vectors == of_solid + 2) found_.kind = Kind::intersector;
        else if (!has_solid && vectors == 2 && (named_ || march_name)) found_.kind = Kind::march;
        else if ((vectors == 1 || (has_solid && vectors == of_solid + 1)) && from_point && (named_ || field_name))
            found_.kind = Kind::field;
        else return false;
        return true;
    }

    bool take_solid() {
        const bool field = found_.kind == Signature::Kind::field;
        std::vector<Role> usual = field ? std::vector{Role::point} : std::vector{Role::origin, Role::direction};
        if (whole_) arguments_[*whole_] = typed("vec4") + "(lb_centre, lb_solid[3])";
        else if (radius_) {
            if (vectors_.size() != usual.size() + 1) return false;
            // The centre stands in front of its radius.
            const auto before =
                std::ranges::find(vectors_, *radius_ == 0 ? vectors_.back() : *radius_ - 1) - vectors_.begin();
            usual.insert(usual.begin() + std::min<std::ptrdiff_t>(before, std::ssize(usual)), Role::centre);
        } else if (vectors_.size() == usual.size() + 2) {
            found_.shape = Shape::box;
            usual.insert(usual.end(), {Role::lo, Role::hi});
        }
        if (usual.size() != vectors_.size()) return false;
        std::vector<const Parameter*> all;
        for (const std::size_t k : vectors_) all.push_back(&found_.function.parameters[k]);
        const std::vector<Role> roles = roles_of(all, usual);
        for (std::size_t k = 0; k < roles.size(); ++k) arguments_[vectors_[k]] = expression_of(roles[k]);
        return true;
    }

    bool take_answer() {
        using Answers = Signature::Answers;
        const std::string& type = found_.function.type;
        if (type == "bool") {
            if (found_.outputs.size() > 2) found_.outputs.resize(2);
            found_.answers = found_.outputs.empty()       ? Answers::hit
                             : found_.outputs.size() == 1 ? Answers::hit_and_t
                                                          : Answers::hit_and_near_far;
            return true;
        }
        found_.outputs.clear();
        found_.answers = type == scalar() ? Answers::t : Answers::near_far;
        const bool one = found_.kind == Signature::Kind::field;
        return type == scalar() || (!one && type == typed("vec2"));
    }

    bool named_, of_hlsl_ = false;
    Signature found_;
    std::vector<std::string> arguments_;
    std::vector<std::size_t> vectors_;
    std::optional<std::size_t> whole_, radius_;
};

}  // namespace

const std::string_view known_signatures =
    "`float` or `vec2 NAME(vec3 ro, vec3 rd, vec4 sphere)`, `(vec3 ro, vec3 rd, vec3 center, float radius)`, for boxes "
    "`(vec3 ro, vec3 rd, vec3 lo, vec3 hi)`; or `bool` with `out float t`, or `out float near, out float far`; for "
    "marches "
    "`float march(vec3 ro, vec3 rd)` or `float map(vec3 p)`";

std::optional<Signature> signature_of(const Function& function, bool named) { return Reader(function, named).read(); }

}  // namespace lostbits::intersect::shader
