#include "intersect/shader/signature.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>

namespace lostbits::intersect::shader {
namespace {

using Qualifier = Parameter::Qualifier;

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

/// Other spellings of the points of primitives, by the names of their keys: parts of a name, and whole names.
constexpr struct {
    std::string_view key;
    std::array<std::string_view, 3> parts;
    std::array<std::string_view, 5> words;
} spellings[] = {{"centre", {"cent"}, {"c", "ce", "pos", "sc", "sphere"}},
                 {"lo", {"min", "low"}, {"lo", "a", "lb", "bl", "p1"}},
                 {"radii", {"radii", "semi"}, {"ra", "r", "radius", "abc"}},
                 {"hi", {"max", "upp", "hig"}, {"hi", "b", "rt", "ur", "p2"}}};

std::string variable_of(std::string_view key) { return "lb_" + std::string(key); }

constexpr std::string_view origin = "lb_origin", direction = "lb_direction", inverse = "(1.0 / lb_direction)";

bool is_named(const Key& key, const std::string& name) {
    return !name.empty() && (name == key.name || std::ranges::find(key.aliases, name) != key.aliases.end());
}

/// The key of a shape with that name and that many numbers; null if there is none.
const Key* key_named(const ShapeRow& row, const std::string& name, std::size_t numbers) {
    const auto key =
        std::ranges::find_if(row.keys, [&](const Key& k) { return k.count() == numbers && is_named(k, name); });
    return key == row.keys.end() ? nullptr : &*key;
}

/// The expression that the name of a vec3 stands for; empty if the name says nothing. The keys of `shape` take
/// precedence: a capsule has a `start`, and a triangle may have a `p0`.
std::string role_of(const std::string& named, const ShapeRow* shape = nullptr) {
    const std::string name = lower(named);
    if (const Key* key = shape == nullptr ? nullptr : key_named(*shape, name, 3)) return variable_of(key->name);
    const auto has = [&name](const auto& parts) {
        return std::ranges::any_of(
            parts, [&](std::string_view part) { return !part.empty() && name.find(part) != std::string::npos; });
    };
    const auto is = [&name](const auto& words) { return std::ranges::find(words, name) != std::ranges::end(words); };
    using Words = std::initializer_list<std::string_view>;
    if (has(Words{"inv", "rcp"})) return std::string(inverse);
    if (has(Words{"dir"}) || is(Words{"rd", "d", "rdir", "v", "raydir"})) return std::string(direction);
    if (has(Words{"orig"}) || is(Words{"ro", "o", "eye", "start", "p0", "e"})) return std::string(origin);
    for (const auto& spelling : spellings)
        if (has(spelling.parts) || is(spelling.words)) return variable_of(spelling.key);
    for (const ShapeRow& row : shape_rows)
        if (const Key* key = key_named(row, name, 3)) return variable_of(key->name);
    return {};
}

/// The roles of the vectors: the usual order of shader sites, or the order that the names give if they name each role
/// once.
std::vector<std::string> roles_of(const std::vector<const Parameter*>& vectors, std::vector<std::string> usual,
                                  const ShapeRow* shape) {
    std::vector<std::string> named;
    for (const Parameter* p : vectors) {
        const std::string role = role_of(p->name, shape);
        named.push_back(role == inverse ? std::string(direction) : role);
    }
    if (std::ranges::is_permutation(named, usual)) usual = named;
    for (std::size_t k = 0; k < vectors.size(); ++k)
        if (usual[k] == direction && role_of(vectors[k]->name, shape) == inverse) usual[k] = inverse;
    return usual;
}

/// Number of keys that have this many numbers.
std::size_t count_of(const ShapeRow& row, std::size_t numbers) {
    return static_cast<std::size_t>(std::ranges::count(row.keys, numbers, &Key::count));
}

bool contains_any(const std::string& name, std::initializer_list<std::string_view> parts) {
    return std::ranges::any_of(parts, [&](std::string_view part) { return name.find(part) != std::string::npos; });
}

/// Reads the signature of one function from its parameters.
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
        if (!take_kind()) return {};
        take_primitive();
        if (!take_answer()) return {};
        found_.arguments = std::move(arguments_);
        return std::move(found_);
    }

private:
    /// A type such as `vec3` in the function's spelling: dvec3 in doubles, float3 in HLSL.
    [[nodiscard]] std::string typed(const std::string& type) const {
        return of_hlsl_ ? "float" + type.substr(3) : (found_.doubles ? "d" : "") + type;
    }
    [[nodiscard]] std::string scalar() const { return found_.doubles ? "double" : "float"; }

    /// Assigns a parameter to its kind. False if no intersector takes such a parameter.
    bool sort(const Parameter& p, std::size_t k) {
        if (p.type.find('[') != std::string::npos || p.name.find('[') != std::string::npos) return false;
        if (p.qualifier != Qualifier::in) {
            arguments_[k] = "lb_out_" + std::to_string(k);
            if (p.type == scalar()) found_.outputs.push_back(arguments_[k]);
            found_.knows_end = found_.knows_end || (p.qualifier == Qualifier::inout && p.type == scalar());
            return true;
        }
        if (p.type == typed("vec3")) vectors_.push_back(k);
        else if (p.type == typed("vec4") && !whole_) whole_ = k;
        else if (p.type == scalar()) return take_number(p, k);
        else return false;
        return true;
    }

    /// Takes a number as a length of the primitive, or as the beginning or the end of the ray.
    bool take_number(const Parameter& p, std::size_t k) {
        const std::string name = lower(p.name);
        // Keys first: the `minor_radius` of a torus contains "min" and is not a minimum.
        if (std::ranges::any_of(shape_rows, [&](const ShapeRow& row) { return key_named(row, name, 1) != nullptr; })) {
            lengths_.push_back(k);
            return true;
        }
        const auto has = [&name](const char* part) { return name.find(part) != std::string::npos; };
        if (has("min") || has("start")) {
            arguments_[k] = "lb_tmin";
            found_.knows_start = true;
        } else if (has("max") || has("end")) {
            arguments_[k] = "lb_tmax";
            found_.knows_end = true;
        } else {
            lengths_.push_back(k);
        }
        return true;
    }

    /// Chooses the shape that has as many points and lengths as the function has beside `own` vectors. If several do,
    /// the one all of whose keys are names of parameters, or else the first.
    bool choose_shape(std::size_t own) {
        if (vectors_.size() < own || (whole_ && vectors_.size() > own)) return false;
        const auto is_parameter = [this](const Key& key) {
            return std::ranges::any_of(found_.function.parameters, [&key](const Parameter& p) {
                return is_named(key, lower(p.name)) || (key.count() == 3 && role_of(p.name) == variable_of(key.name));
            });
        };
        const std::size_t points = whole_ ? 1 : vectors_.size() - own, lengths = whole_ ? 1 : lengths_.size();
        for (const ShapeRow& row : shape_rows) {
            if (count_of(row, 3) != points || count_of(row, 1) != lengths) continue;
            if (shape_ == nullptr || std::ranges::all_of(row.keys, is_parameter)) shape_ = &row;
        }
        return shape_ != nullptr;
    }

    /// Decides between intersector, march and field: it follows from the number of vectors that belong to the
    /// primitive.
    bool take_kind() {
        using Kind = Signature::Kind;
        const std::size_t vectors = vectors_.size();
        const std::string name = lower(found_.function.name);
        const bool field_name = contains_any(name, {"map", "sdf", "scene", "field", "getdist"}) || name == "de";
        const bool march_name = contains_any(name, {"march", "trace", "cast"});
        const bool has_primitive = whole_ || !lengths_.empty() || vectors > 2;
        const bool from_point = vectors > 0 && role_of(found_.function.parameters[vectors_[0]].name) != origin;
        if (has_primitive && choose_shape(2)) found_.kind = Kind::intersector;
        else if (!has_primitive && vectors == 2 && (named_ || march_name)) found_.kind = Kind::march;
        else if (from_point && (named_ || field_name) && (has_primitive ? choose_shape(1) : vectors == 1))
            found_.kind = Kind::field;
        else return false;
        return true;
    }

    void take_primitive() {
        const bool field = found_.kind == Signature::Kind::field;
        std::vector<std::string> usual;
        if (field) usual = {"lb_point"};
        else usual = {std::string(origin), std::string(direction)};
        if (shape_ != nullptr) add_primitive(usual);
        std::vector<const Parameter*> all;
        for (const std::size_t k : vectors_) all.push_back(&found_.function.parameters[k]);
        const std::vector<std::string> roles = roles_of(all, usual, shape_);
        for (std::size_t k = 0; k < roles.size(); ++k) arguments_[vectors_[k]] = roles[k];
    }

    /// Takes the lengths of the primitive, and inserts its points among the vectors where they usually stand.
    void add_primitive(std::vector<std::string>& usual) {
        found_.shape = shape_->shape;
        std::vector<std::string> points;
        std::size_t length = 0;
        for_each_key(shape_->shape, [&](const Key& key, std::size_t first) {
            const std::string number = "lb_primitive[" + std::to_string(first) + "]";
            if (key.count() == 3) points.push_back(variable_of(key.name));
            else if (whole_) arguments_[*whole_] = typed("vec4") + "(" + points.front() + ", " + number + ")";
            else arguments_[lengths_[length++]] = number;
        });
        if (whole_) return;
        std::ptrdiff_t before = std::ssize(usual);
        if (points.size() == 1 && !lengths_.empty()) {
            // A centre comes right before its radius.
            const std::size_t centre = lengths_[0] == 0 ? vectors_.back() : lengths_[0] - 1;
            before = std::min<std::ptrdiff_t>(before, std::ranges::find(vectors_, centre) - vectors_.begin());
        }
        usual.insert(usual.begin() + before, points.begin(), points.end());
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
    std::vector<std::size_t> vectors_, lengths_;  ///< indices of parameters
    std::optional<std::size_t> whole_;            ///< index of a vec4
    const ShapeRow* shape_ = nullptr;
};

}  // namespace

const std::string_view known_signatures =
    "`float` or `vec2 NAME(vec3 ro, vec3 rd, vec4 sphere)`, `(vec3 ro, vec3 rd, vec3 center, float radius)`, for boxes "
    "`(vec3 ro, vec3 rd, vec3 lo, vec3 hi)`; or `bool` with `out float t`, or `out float near, out float far`; for "
    "marches `float march(vec3 ro, vec3 rd)` or `float map(vec3 p)`";

std::optional<Signature> signature_of(const Function& function, bool named) { return Reader(function, named).read(); }

}  // namespace lostbits::intersect::shader
