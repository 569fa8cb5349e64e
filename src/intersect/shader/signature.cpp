#include "intersect/shader/signature.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>

namespace lostbits::intersect::shader {
namespace {

using Qualifier = Parameter::Qualifier;

std::string lower_case(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

/// Other spellings of the points of primitives, by the names of their keys: fragments of a name, and whole names.
constexpr struct {
    std::string_view key;
    std::array<std::string_view, 3> fragments;
    std::array<std::string_view, 5> names;
} spellings[] = {{"centre", {"cent"}, {"c", "ce", "pos", "sc", "sphere"}},
                 {"lo", {"min", "low"}, {"lo", "a", "lb", "bl", "p1"}},
                 {"radii", {"radii", "semi"}, {"ra", "r", "radius", "abc"}},
                 {"hi", {"max", "upp", "hig"}, {"hi", "b", "rt", "ur", "p2"}}};

std::string variable_of(std::string_view key) { return "lb_" + std::string(key); }

constexpr std::string_view origin = "lb_origin", direction = "lb_direction", inverse = "(1.0 / lb_direction)";

bool is_named(const Key& key, const std::string& name) {
    return !name.empty() && (name == key.name || std::ranges::find(key.aliases, name) != key.aliases.end());
}

/// Returns the key of a shape with that name and that number of numbers; null if the shape has no such key.
const Key* key_named(const ShapeRow& shape_row, const std::string& name, std::size_t number_count) {
    const auto found = std::ranges::find_if(
        shape_row.keys, [&](const Key& key) { return key.count() == number_count && is_named(key, name); });
    return found == shape_row.keys.end() ? nullptr : &*found;
}

/// Returns the expression for the argument with the name of a vec3; empty if the name is not recognised. The keys of
/// `shape` take precedence: a capsule has a `start`, and a triangle may have a `p0`.
std::string role_of(const std::string& parameter_name, const ShapeRow* shape = nullptr) {
    const std::string name = lower_case(parameter_name);
    if (const Key* key = shape == nullptr ? nullptr : key_named(*shape, name, 3)) return variable_of(key->name);
    const auto contains = [&name](const auto& fragments) {
        return std::ranges::any_of(fragments, [&](std::string_view fragment) {
            return !fragment.empty() && name.find(fragment) != std::string::npos;
        });
    };
    const auto equals = [&name](const auto& names) {
        return std::ranges::find(names, name) != std::ranges::end(names);
    };
    using Texts = std::initializer_list<std::string_view>;
    if (contains(Texts{"inv", "rcp"})) return std::string(inverse);
    if (contains(Texts{"dir"}) || equals(Texts{"rd", "d", "rdir", "v", "raydir"})) return std::string(direction);
    if (contains(Texts{"orig"}) || equals(Texts{"ro", "o", "eye", "start", "p0", "e"})) return std::string(origin);
    for (const auto& spelling : spellings)
        if (contains(spelling.fragments) || equals(spelling.names)) return variable_of(spelling.key);
    for (const ShapeRow& shape_row : shape_rows)
        if (const Key* key = key_named(shape_row, name, 3)) return variable_of(key->name);
    return {};
}

/// Returns the roles of the vectors: the usual order of shader sites, or the order of the parameters' names if the
/// names give each role once.
std::vector<std::string> roles_of(const std::vector<const Parameter*>& vectors, std::vector<std::string> roles,
                                  const ShapeRow* shape) {
    std::vector<std::string> named_roles;
    for (const Parameter* p : vectors) {
        const std::string role = role_of(p->name, shape);
        named_roles.push_back(role == inverse ? std::string(direction) : role);
    }
    if (std::ranges::is_permutation(named_roles, roles)) roles = named_roles;
    for (std::size_t k = 0; k < vectors.size(); ++k)
        if (roles[k] == direction && role_of(vectors[k]->name, shape) == inverse) roles[k] = inverse;
    return roles;
}

/// Number of keys that have this many numbers.
std::size_t count_of(const ShapeRow& shape_row, std::size_t number_count) {
    return static_cast<std::size_t>(std::ranges::count(shape_row.keys, number_count, &Key::count));
}

bool contains_any(const std::string& name, std::initializer_list<std::string_view> fragments) {
    return std::ranges::any_of(fragments,
                               [&](std::string_view fragment) { return name.find(fragment) != std::string::npos; });
}

/// Reads the signature of one function from its parameters.
class SignatureReader {
public:
    SignatureReader(const Function& function, bool is_named_by_user) : is_named_by_user_(is_named_by_user) {
        signature_.function = function;
    }

    std::optional<Signature> read() {
        const auto has_type = [&function = signature_.function](std::initializer_list<std::string_view> types) {
            return std::ranges::any_of(function.parameters, [types](const Parameter& parameter) {
                return std::ranges::find(types, parameter.type) != types.end();
            });
        };
        signature_.is_double = has_type({"dvec3", "dvec4", "double"});
        is_hlsl_ = has_type({"float3", "float4"});
        arguments_.resize(signature_.function.parameters.size());
        for (std::size_t k = 0; k < arguments_.size(); ++k) {
            if (!assign_parameter(signature_.function.parameters[k], k)) return {};
        }
        if (!choose_kind()) return {};
        set_primitive_arguments();
        if (!choose_answers()) return {};
        signature_.arguments = std::move(arguments_);
        return std::move(signature_);
    }

private:
    /// A type such as `vec3` in the function's spelling: dvec3 in doubles, float3 in HLSL.
    [[nodiscard]] std::string type_name(const std::string& type) const {
        return is_hlsl_ ? "float" + type.substr(3) : (signature_.is_double ? "d" : "") + type;
    }
    [[nodiscard]] std::string scalar_type() const { return signature_.is_double ? "double" : "float"; }

    /// Assigns a parameter to a role or a list. Returns false if no intersector takes such a parameter.
    bool assign_parameter(const Parameter& parameter, std::size_t k) {
        if (parameter.type.find('[') != std::string::npos || parameter.name.find('[') != std::string::npos)
            return false;
        if (parameter.qualifier != Qualifier::in) {
            arguments_[k] = "lb_out_" + std::to_string(k);
            if (parameter.type == scalar_type()) signature_.outputs.push_back(arguments_[k]);
            signature_.takes_end =
                signature_.takes_end || (parameter.qualifier == Qualifier::inout && parameter.type == scalar_type());
            return true;
        }
        if (parameter.type == type_name("vec3")) vectors_.push_back(k);
        else if (parameter.type == type_name("vec4") && !vec4_) vec4_ = k;
        else if (parameter.type == scalar_type()) return assign_number(parameter, k);
        else return false;
        return true;
    }

    /// Assigns a number to the lengths of the primitive, or to the beginning or the end of the ray.
    bool assign_number(const Parameter& parameter, std::size_t k) {
        const std::string name = lower_case(parameter.name);
        // Keys first: the `minor_radius` of a torus contains "min" and is not a minimum.
        if (std::ranges::any_of(shape_rows,
                                [&](const ShapeRow& shape_row) { return key_named(shape_row, name, 1) != nullptr; })) {
            lengths_.push_back(k);
            return true;
        }
        const auto has = [&name](const char* part) { return name.find(part) != std::string::npos; };
        if (has("min") || has("start")) {
            arguments_[k] = "lb_tmin";
            signature_.takes_start = true;
        } else if (has("max") || has("end")) {
            arguments_[k] = "lb_tmax";
            signature_.takes_end = true;
        } else {
            lengths_.push_back(k);
        }
        return true;
    }

    /// Chooses the shape that has as many points and lengths as the function has beside the `ray_vectors` vectors of
    /// the ray. If several shapes match, chooses the shape all of whose keys are names of parameters, or else the
    /// first.
    bool choose_shape(std::size_t ray_vector_count) {
        if (vectors_.size() < ray_vector_count || (vec4_ && vectors_.size() > ray_vector_count)) return false;
        const auto is_parameter = [this](const Key& key) {
            return std::ranges::any_of(signature_.function.parameters, [&key](const Parameter& parameter) {
                return is_named(key, lower_case(parameter.name)) ||
                       (key.count() == 3 && role_of(parameter.name) == variable_of(key.name));
            });
        };
        const std::size_t point_count = vec4_ ? 1 : vectors_.size() - ray_vector_count,
                          lengths = vec4_ ? 1 : lengths_.size();
        for (const ShapeRow& shape_row : shape_rows) {
            if (count_of(shape_row, 3) != point_count || count_of(shape_row, 1) != lengths) continue;
            if (shape_ == nullptr || std::ranges::all_of(shape_row.keys, is_parameter)) shape_ = &shape_row;
        }
        return shape_ != nullptr;
    }

    /// Decides between intersector, march and field. The kind follows from the number of vectors that belong to the
    /// primitive.
    bool choose_kind() {
        using Kind = Signature::Kind;
        const std::size_t vector_count = vectors_.size();
        const std::string name = lower_case(signature_.function.name);
        const bool is_field_name = contains_any(name, {"map", "sdf", "scene", "field", "getdist"}) || name == "de";
        const bool is_march_name = contains_any(name, {"march", "trace", "cast"});

        // The ray of an intersector or a march is two vectors; a field takes one point.
        const bool has_primitive = vec4_ || !lengths_.empty() || vector_count > 2;
        const bool from_point = vector_count > 0 && role_of(signature_.function.parameters[vectors_[0]].name) != origin;
        if (has_primitive && choose_shape(2)) signature_.kind = Kind::intersector;
        else if (!has_primitive && vector_count == 2 && (is_named_by_user_ || is_march_name))
            signature_.kind = Kind::march;
        else if (from_point && (is_named_by_user_ || is_field_name) &&
                 (has_primitive ? choose_shape(1) : vector_count == 1))
            signature_.kind = Kind::field;
        else return false;
        return true;
    }

    void set_primitive_arguments() {
        const bool is_field = signature_.kind == Signature::Kind::field;
        std::vector<std::string> default_roles;
        if (is_field) default_roles = {"lb_point"};
        else default_roles = {std::string(origin), std::string(direction)};
        if (shape_ != nullptr) add_primitive(default_roles);
        std::vector<const Parameter*> vectors;
        for (const std::size_t k : vectors_) vectors.push_back(&signature_.function.parameters[k]);
        const std::vector<std::string> roles = roles_of(vectors, default_roles, shape_);
        for (std::size_t k = 0; k < roles.size(); ++k) arguments_[vectors_[k]] = roles[k];
    }

    /// Assigns the lengths of the primitive, and inserts its points among the vectors where they usually stand.
    void add_primitive(std::vector<std::string>& default_roles) {
        signature_.shape = shape_->shape;
        std::vector<std::string> points;
        std::size_t length = 0;
        for_each_key(shape_->shape, [&](const Key& key, std::size_t first) {
            const std::string number = "lb_primitive[" + std::to_string(first) + "]";
            if (key.count() == 3) points.push_back(variable_of(key.name));
            else if (vec4_) arguments_[*vec4_] = type_name("vec4") + "(" + points.front() + ", " + number + ")";
            else arguments_[lengths_[length++]] = number;
        });
        if (vec4_) return;
        std::ptrdiff_t insert_position = std::ssize(default_roles);
        if (points.size() == 1 && !lengths_.empty()) {
            // A centre comes directly before its radius.
            const std::size_t centre = lengths_[0] == 0 ? vectors_.back() : lengths_[0] - 1;
            insert_position =
                std::min<std::ptrdiff_t>(insert_position, std::ranges::find(vectors_, centre) - vectors_.begin());
        }
        default_roles.insert(default_roles.begin() + insert_position, points.begin(), points.end());
    }

    bool choose_answers() {
        using Answers = Signature::Answers;
        const std::string& type = signature_.function.type;
        if (type == "bool") {
            if (signature_.outputs.size() > 2) signature_.outputs.resize(2);
            signature_.answers = signature_.outputs.empty()       ? Answers::hit
                                 : signature_.outputs.size() == 1 ? Answers::hit_and_t
                                                                  : Answers::hit_and_near_far;
            return true;
        }
        signature_.outputs.clear();
        signature_.answers = type == scalar_type() ? Answers::t : Answers::near_far;
        const bool is_field = signature_.kind == Signature::Kind::field;
        return type == scalar_type() || (!is_field && type == type_name("vec2"));
    }

    bool is_named_by_user_, is_hlsl_ = false;
    Signature signature_;
    std::vector<std::string> arguments_;
    std::vector<std::size_t> vectors_, lengths_;  ///< indices of parameters
    std::optional<std::size_t> vec4_;             ///< index of a parameter of type vec4
    const ShapeRow* shape_ = nullptr;
};

}  // namespace

const std::string_view known_signatures =
    "\n  float NAME(vec3 ro, vec3 rd, vec4 sphere)"
    "\n  float NAME(vec3 ro, vec3 rd, vec3 center, float radius)"
    "\n  float NAME(vec3 ro, vec3 rd, vec3 lo, vec3 hi)  (a box)"
    "\n  each also as vec2, or as bool with `out float t` or `out float near, out float far` at the end"
    "\n  float march(vec3 ro, vec3 rd)"
    "\n  float map(vec3 p)\n";

std::optional<Signature> read_signature(const Function& function, bool is_named_by_user) {
    return SignatureReader(function, is_named_by_user).read();
}

}  // namespace lostbits::intersect::shader
