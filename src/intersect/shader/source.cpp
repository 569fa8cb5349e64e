#include "intersect/shader/source.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "intersect/external/pipe_header.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::shader {

namespace fs = std::filesystem;

namespace {

/// A property of the function, and its position in the file, or the option that states it.
struct Property {
    std::string key, value, where;
};

std::string read_text(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || fs::is_directory(path))
        throw InputError(path.string() + ": cannot be read; --shader takes a GLSL file, and options after a colon");
    if (text.str().size() > 4'000'000) throw InputError(path.string() + ": is longer than 4 MB; is it a GLSL file?");
    return text.str();
}

/// Splits the argument into the file and the options after it.
std::pair<std::string, std::string> split_argument(const std::string& argument) {
    std::error_code error;
    for (std::size_t end = argument.size();; end = argument.rfind(':', end - 1)) {
        if (end == std::string::npos) break;
        if (fs::exists(argument.substr(0, end), error))
            return {argument.substr(0, end), end == argument.size() ? "" : argument.substr(end + 1)};
        if (end == 0) break;
    }
    throw InputError("--shader " + argument + ": no such file; write FILE.glsl or FILE.glsl:FUNCTION");
}

/// Reads properties with `separator` or blanks between them. Quotation marks hold a property together.
void add_properties(std::string_view text, char separator, const std::string& where,
                    std::vector<Property>& properties) {
    const auto separates = [separator](char c) { return c == separator || c == ' ' || c == '\t' || c == '\r'; };
    for (std::size_t position = 0; position < text.size();) {
        if (separates(text[position])) {
            ++position;
            continue;
        }
        std::string property;
        for (bool quoted = false; position < text.size() && (quoted || !separates(text[position])); ++position) {
            if (text[position] == '"') quoted = !quoted;
            else property += text[position];
        }
        const std::size_t equals = property.find('=');
        if (equals == std::string::npos) properties.push_back({"function", property, where});
        else properties.push_back({property.substr(0, equals), property.substr(equals + 1), where});
    }
}

/// Reads the properties that comments of the file state after `lostbits:`, up to the end of the line.
void add_comment_properties(const std::string& path, const std::vector<Token>& tokens,
                            std::vector<Property>& properties) {
    constexpr std::string_view mark = "lostbits:";
    for (const Token& token : tokens) {
        if (token.kind != Token::Kind::comment) continue;
        std::size_t line = token.line, counted_to = 0;
        for (std::size_t position = token.text.find(mark); position != std::string_view::npos;
             position = token.text.find(mark, position)) {
            line += static_cast<std::size_t>(
                std::ranges::count(token.text.substr(counted_to, position - counted_to), '\n'));
            const std::size_t newline = token.text.rfind('\n', position);
            const std::size_t column = newline == std::string_view::npos ? token.column + position : position - newline;

            // The properties end with the line, or with the comment.
            const std::size_t end = std::min(token.text.find('\n', position), token.text.size());
            std::string_view rest = token.text.substr(position + mark.size(), end - position - mark.size());
            if (rest.ends_with("*/")) rest.remove_suffix(2);
            add_properties(rest, ' ', path + ":" + std::to_string(line) + ":" + std::to_string(column), properties);
            counted_to = position;
            position = end;
        }
    }
}

MissSentinel read_miss_sentinel(const Property& property) {
    using Kind = MissSentinel::Kind;
    constexpr std::array<std::string_view, 4> kinds{"negative", "crossed", "zero", "infinite"};
    const auto kind = std::ranges::find(kinds, property.value);
    if (kind != kinds.end()) return {static_cast<Kind>(kind - kinds.begin()), 0};
    MissSentinel above{Kind::above, 0};
    const auto [end, error] =
        std::from_chars(property.value.data(), property.value.data() + property.value.size(), above.bound);
    if (error == std::errc() && end == property.value.data() + property.value.size() && above.bound > 0) return above;
    throw InputError(property.where + ": miss is " + external::quote_text(property.value) +
                     "; it must be negative (t < 0 means a miss), crossed (near > far), zero (t <= 0), infinite, or a "
                     "number from which on t means a miss, such as 1e20");
}

std::string place_text(const std::string& path, const Function& function) {
    return path + ":" + std::to_string(function.line) + ":" + std::to_string(function.column);
}

std::string list_text(const std::vector<Function>& functions) {
    constexpr std::size_t max_listed = 30;
    std::string text;
    for (const Function& function : functions) {
        if (&function - functions.data() == max_listed)
            return text + "\n  and " + std::to_string(functions.size() - max_listed) + " more";
        text += "\n  line " + std::to_string(function.line) + ": " + function.declaration();
    }
    return text;
}

/// Returns the functions with the signature of the first kind that the file has (intersector, march, field), since a
/// file with a march also has a field.
std::vector<Function> candidate_functions(const std::vector<Function>& functions) {
    std::vector<Function> best;
    auto kind = Signature::Kind::field;
    for (const Function& function : functions) {
        const auto signature = read_signature(function);
        if (!signature || (!best.empty() && signature->kind > kind)) continue;
        if (signature->kind < kind) best.clear();
        kind = signature->kind;
        best.push_back(function);
    }
    return best;
}

/// Chooses the function that the user names, or else the only function that has the types of an intersector.
Signature choose_function(const std::string& path, const std::vector<Function>& functions,
                          const Property* function_property) {
    constexpr std::array compiled_endings{".c", ".cc", ".cpp", ".cxx", ".rs"};
    const bool is_compiled = std::ranges::find(compiled_endings, fs::path(path).extension()) != compiled_endings.end();
    const std::string advice =
        !is_compiled ? "" : "\n--shader is for GLSL and HLSL; for C, C++ or Rust write --function " + path;
    if (functions.empty())
        throw InputError(path + ": contains no function; write one, such as float f(vec3 ro, vec3 rd, vec4 sphere)" +
                         advice);

    // The functions with the stated name, or else those with the types of an intersector.
    std::vector<Function> chosen;
    if (function_property)
        std::ranges::copy_if(functions, std::back_inserter(chosen),
                             [&](const Function& function) { return function.name == function_property->value; });
    else chosen = candidate_functions(functions);

    if (chosen.empty() && function_property)
        throw InputError(function_property->where + ": no function " + external::quote_text(function_property->value) +
                         " in " + path + "; its functions are:" + list_text(functions));
    if (chosen.empty())
        throw InputError(path + ": no function has the types of an intersector, which are:" +
                         std::string(known_signatures) + "The functions of the file are:" + list_text(functions) +
                         "\nwrite one that calls yours, or name it as in --shader " + path + ":FUNCTION" + advice);
    if (!function_property && chosen.size() > 1)
        throw InputError(path + ": several functions have the types of an intersector; name one, as in --shader " +
                         path + ":" + chosen.back().name + ":" + list_text(chosen));

    // A function may have overloads of other types.
    for (const Function& function : chosen) {
        if (auto signature = read_signature(function, function_property != nullptr)) return *signature;
    }
    throw InputError(place_text(path, chosen.front()) + ": `" + chosen.front().declaration() +
                     "` does not have the types of an intersector, which are:" + std::string(known_signatures) +
                     "Write a function that calls it");
}

/// Returns the default contract: the properties of most functions with such a signature.
external::Contract default_contract(const std::string& path, const Signature& signature) {
    external::Contract c{.name = fs::path(path).stem().string(),
                         .title = signature.function.declaration(),
                         .source = {},
                         .shape = signature.shape,
                         .bits = signature.is_double ? 64 : 32};
    using Answers = Signature::Answers;
    c.direction = row_of(signature.shape).usually_takes_unit_direction ? Direction::unit : Direction::any;
    const bool has_two_roots = signature.answers == Answers::near_far || signature.answers == Answers::hit_and_near_far;
    c.roots = has_two_roots ? Roots::both : signature.answers == Answers::hit ? Roots::none : Roots::near_only;

    // A march or a field needs a unit direction, and ends where it begins if that is inside.
    if (signature.kind != Signature::Kind::intersector) {
        c.direction = Direction::unit;
        c.roots = has_two_roots ? Roots::both : Roots::near_only;
    }
    const bool returns_zero_inside =
        signature.kind != Signature::Kind::intersector || inside_returns_zero(signature.shape);
    if (c.roots == Roots::near_only && returns_zero_inside) c.inside = Inside::zero;
    c.flags = LB_ONE_THREAD;
    return c;
}

/// Changes the name to `shader.NAME`, replaces characters that a name may not have, and shortens a long title.
void normalize_name(external::Contract& contract) {
    for (char& c : contract.name) {
        const bool is_allowed = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
        if (!is_allowed) c = '_';
    }
    contract.name = "shader." + contract.name.substr(0, 40);
    constexpr std::size_t max_title = 120;
    if (contract.title.size() > max_title) contract.title = contract.title.substr(0, max_title) + "...";
}

/// Reads a number x with 0 < x < 1e30.
double positive_number(const Property& property) {
    double number = 0;
    const char* const end = property.value.data() + property.value.size();
    const auto [stop, error] = std::from_chars(property.value.data(), end, number);
    if (error != std::errc() || stop != end || !(number > 0) || !(number < 1e30))
        throw InputError(property.where + ": " + property.key + " is " + external::quote_text(property.value) +
                         "; it must be a number above 0 and below 1e30");
    return number;
}

void set_formats(const Property& property, ShaderSource& shader) {
    if (property.value != "f32" && property.value != "f64" && property.value != "both")
        throw InputError(property.where + ": format is " + external::quote_text(property.value) +
                         "; it must be f32, f64 or both");
    shader.f32 = property.value != "f64";
    shader.f64 = property.value != "f32";
}

void apply_property(const Property& property, ShaderSource& shader) {
    const bool own_primitives =
        shader.signature.kind == Signature::Kind::march || shader.signature.arguments.size() == 1;
    if (property.key == "function") return;
    if (property.key == "miss") shader.miss_sentinel = read_miss_sentinel(property);
    else if (property.key == "format") set_formats(property, shader);
    else if (property.key == "hit_eps") shader.march.hit_eps = positive_number(property);
    else if (property.key == "max_dist") shader.march.max_dist = positive_number(property);
    else if (property.key == "max_steps")
        shader.march.max_steps = static_cast<int>(std::min(positive_number(property), 1e9));
    else if ((property.key == "shape" && !own_primitives) || property.key == "source" ||
             !external::set_property(shader.contract, property.key, property.value, property.where))
        throw InputError(property.where + ": unknown key " + external::quote_text(property.key) +
                         "; known keys are function, name, title, direction, roots, touching, at_origin, inside, "
                         "facing, flags, miss and format; for a field also hit_eps, max_dist and max_steps; for a "
                         "march or field with its own primitives also shape");
}

/// Throws InputError if the function does not receive where rays begin and end.
void require_range(const std::string& path, const Signature& signature) {
    const std::string message_start = place_text(path, signature.function) + ": flags=range is given, but `" +
                                      signature.function.declaration() + "` ";
    if (signature.kind == Signature::Kind::field)
        throw InputError(message_start +
                         "is a field: the loop around it begins at 0; write the march yourself, or leave range out: "
                         "lostbits then accepts only answers in the range");
    if (!signature.takes_start || !signature.takes_end)
        throw InputError(
            message_start +
            "has no parameters for where rays begin and end; add `float tmin, float tmax`, or leave range out: "
            "lostbits then takes the first root in the range");
}

}  // namespace

bool MissSentinel::means_miss(double near, double far) const {
    switch (kind) {
        case Kind::negative: return far < 0;
        case Kind::crossed: return near > far || far < 0;
        case Kind::zero: return far <= 0;
        case Kind::infinite: return !std::isfinite(near);
        case Kind::above: return near >= bound;
    }
    return false;
}

ShaderSource read_shader(const std::string& argument) {
    const auto [path, options] = split_argument(argument);
    ShaderSource shader{.path = path,
                        .text = read_text(path),
                        .signature = {},
                        .contract = {},
                        .miss_sentinel = {},
                        .march = {},
                        .is_hlsl = fs::path(path).extension() == ".hlsl",
                        .loops = {}};
    const std::vector<Token> tokens = split_into_tokens(shader.text), code = code_tokens(tokens);

    // Reads the properties that comments and the command line state. The last of them take precedence.
    std::vector<Property> properties;
    add_comment_properties(path, tokens, properties);
    add_properties(options, ',', "--shader " + argument, properties);

    // Chooses the function, and sets the usual properties of its signature.
    const auto is_function = [](const Property& property) { return property.key == "function"; };
    const auto function = std::find_if(properties.rbegin(), properties.rend(), is_function);
    shader.signature =
        choose_function(path, find_functions(code), function == properties.rend() ? nullptr : &*function);
    shader.contract = default_contract(path, shader.signature);
    if (function != properties.rend() && function->where.starts_with("--shader"))
        shader.contract.name = function->value;
    if (shader.signature.answers == Signature::Answers::near_far)
        shader.miss_sentinel.kind = MissSentinel::Kind::crossed;
    shader.f32 = !shader.signature.is_double;
    shader.f64 = shader.signature.is_double;
    for (const Property& property : properties) apply_property(property, shader);

    // Completes and checks the contract.
    if (shader.is_hlsl && shader.f64) throw InputError(path + ": HLSL is measured in floats only; leave format= out");
    if ((shader.contract.flags & LB_RANGE) != 0) require_range(path, shader.signature);
    normalize_name(shader.contract);
    shader.signature.shape = shader.contract.shape;
    const bool form_takes_end = takes_tmax(shader.contract.shape) && shader.contract.roots != Roots::none;
    if (form_takes_end && !shader.signature.takes_end) shader.contract.flags |= LB_NO_END;
    external::require_valid(shader.contract, path);

    // The loops with a bound, or without an end. A field is marched in one more.
    shader.loops = find_counted_loops(tokens, code);
    if (shader.signature.kind == Signature::Kind::field)
        shader.loops.push_back({shader.signature.function.line, shader.march.max_steps, shader.march.max_steps});
    return shader;
}

}  // namespace lostbits::intersect::shader
