#include "intersect/shader/kernel.hpp"

#include <array>
#include <cstdio>
#include <map>
#include <set>
#include <utility>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::shader {
namespace {

void blank(std::string& text, const Token& token) {
    text.replace(token.offset, token.text.size(), token.text.size(), ' ');
}

/// A name that only other shader stages or shader sites define, and its value here.
struct PredefinedName {
    std::string_view name, value;
};
constexpr std::array<PredefinedName, 10> predefined_names{{{"iResolution", "vec3(640.0, 360.0, 1.0)"},
                                                           {"iTime", "0.0"},
                                                           {"iGlobalTime", "0.0"},
                                                           {"iTimeDelta", "0.0"},
                                                           {"iFrameRate", "60.0"},
                                                           {"iFrame", "0"},
                                                           {"iMouse", "vec4(0.0)"},
                                                           {"iDate", "vec4(0.0)"},
                                                           {"iSampleRate", "44100.0"},
                                                           {"lb_FragCoord", "vec4(0.5, 0.5, 0.0, 1.0)"}}};

/// An offset in a text, and what is inserted before that byte.
using Insertion = std::pair<std::size_t, std::string>;

/// Turns a uniform such as `uniform vec2 size;`, whose first token has the index `first`, into a variable, since Vulkan
/// allows uniforms only in blocks. With `initialized` the variable gets the value 0. Blocks and samplers stay.
void add_zero_initializer(std::string& text, std::vector<Insertion>& insertions, const std::vector<Token>& tokens,
                          std::size_t first, bool initialized) {
    static const std::set<std::string_view> types{"float", "int", "uint", "bool", "vec2", "vec3", "vec4", "double"};
    if (first + 3 >= tokens.size() || !types.contains(tokens[first + 1].text) || tokens[first + 3].text != ";") return;
    blank(text, tokens[first]);
    if (initialized)
        insertions.emplace_back(tokens[first + 3].offset, " = " + std::string(tokens[first + 1].text) + "(0)");
}

/// Applies all insertions in one pass, so that the text is copied once.
std::string with_insertions(const std::string& text, const std::vector<Insertion>& insertions) {
    std::string result;
    std::size_t copied = 0;
    for (const auto& [offset, inserted] : insertions) {
        result += text.substr(copied, offset - copied) + inserted;
        copied = offset;
    }
    return result + text.substr(copied);
}

/// Rewrites the user's text so that a compute program can contain it. Every line and column keeps its position. Without
/// `initialize_uniforms`, uniforms get no value.
std::string as_compute_code(const std::string& original, bool initialize_uniforms = true) {
    std::string text = original;
    const std::vector<Token> tokens = split_into_tokens(original);
    int depth = 0;
    std::vector<Insertion> insertions;
    std::size_t version_line = 0;
    bool in_layout = false;
    for (std::size_t i = 0; i < tokens.size(); ++i) {
        const Token& t = tokens[i];
        if (t.kind == Token::Kind::comment) continue;

        // The program has a line #version of its own.
        if (t.in_directive) {
            const bool is_version_directive = t.text == "#" && i + 1 < tokens.size() &&
                                              tokens[i + 1].text == "version" &&
                                              t.line != version_line;  // each such line only once
            if (is_version_directive) version_line = t.line;
            for (std::size_t k = i; is_version_directive && k < tokens.size() && tokens[k].line == t.line; ++k) {
                if (tokens[k].kind != Token::Kind::comment) blank(text, tokens[k]);
            }
        }

        // Renames what only other stages have.
        if (t.text == "{" || t.text == "(") ++depth;
        if (t.text == "}" || t.text == ")") --depth;
        if (t.text.starts_with("gl_Frag")) text.replace(t.offset, 2, "lb");
        if (t.text == "main") text.replace(t.offset, 4, "lb_m");
        if (depth == 0 && t.text == "uniform") add_zero_initializer(text, insertions, tokens, i, initialize_uniforms);

        // `layout(location = 0) out vec4 color;` of the file becomes a variable.
        static const std::set<std::string_view> qualifiers{"in",   "out",    "varying", "attribute",
                                                           "flat", "smooth", "layout"};
        if (depth == 0 && !t.in_directive && qualifiers.contains(t.text)) {
            blank(text, t);
            in_layout = t.text == "layout";
        } else if (in_layout && !t.in_directive) {
            blank(text, t);
            in_layout = !(t.text == ")" && depth == 0);
        }
    }
    return with_insertions(text, insertions);
}

/// Declares names that the text uses and does not declare: names that web sites for shaders, such as Shadertoy,
/// provide, and names of other stages. Constants are written as `#define`, because an `#extension` directive of the
/// text may come after directives, but not after declarations. Outputs and channels are variables.
std::string site_declarations(const std::string& text) {
    const std::vector<Token> code = code_tokens(split_into_tokens(text));
    static const std::set<std::string_view> site_types{"float", "int", "vec2", "vec3", "vec4", "sampler2D"};
    std::set<std::string_view> used, declared;
    for (std::size_t i = 0; i < code.size(); ++i) {
        used.insert(code[i].text);
        if (i + 1 < code.size() && site_types.contains(code[i].text)) declared.insert(code[i + 1].text);
    }

    std::string declarations;
    for (const PredefinedName& predefined : predefined_names) {
        if (used.contains(predefined.name) && !declared.contains(predefined.name))
            declarations += "#define " + std::string(predefined.name) + " " + std::string(predefined.value) + "\n";
    }
    if (used.contains("lb_FragColor")) declarations += "vec4 lb_FragColor;\n";
    if (used.contains("lb_FragDepth")) declarations += "float lb_FragDepth;\n";
    for (const std::string channel : {"iChannel0", "iChannel1", "iChannel2", "iChannel3"}) {
        if (used.contains(channel) && !declared.contains(channel))
            declarations += "layout(binding = " + std::to_string(8 + channel.back() - '0') + ") uniform sampler2D " +
                            channel + ";\n";
    }
    return declarations;
}

/// Code of the loop that marches a field. Its constants are written as decimals that are read back without a change.
std::string march_code(const Signature& signature, const ShaderMarch& march, const std::string& call) {
    const auto number = [&signature](double x) {
        std::array<char, 40> text{};
        std::snprintf(text.data(), text.size(), "%.17e%s", x, signature.is_double ? "LF" : "");
        return std::string(text.data());
    };
    const std::string real = signature.is_double ? "double" : "float", vector = signature.is_double ? "dvec3" : "vec3";
    return "    " + real + " lb_t = " + real + "(0), lb_says = " + real + "(-1);\n    for (int lb_k = 0; lb_k < " +
           std::to_string(march.max_steps) + "; ++lb_k) {\n        " + vector +
           " lb_point = lb_origin + lb_direction * lb_t;\n        " + real + " lb_d = " + call +
           ";\n        if (lb_d < " + number(march.hit_eps) +
           ") {\n            lb_says = lb_t;\n            break;\n        }\n        lb_t += lb_d;\n        if (lb_t "
           "> " +
           number(march.max_dist) + ") break;\n    }\n";
}

/// Code that calls the function and stores its answer.
std::string call_code(const Signature& signature, const ShaderMarch& march) {
    using Answers = Signature::Answers;

    // Declares a variable for each output; one that is also an input receives the end of the ray.
    std::string code, list;
    for (std::size_t k = 0; k < signature.arguments.size(); ++k) {
        const Parameter& p = signature.function.parameters[k];
        if (p.qualifier != Parameter::Qualifier::in)
            code += "    " + p.type + " " + signature.arguments[k] + " = " + p.type + "(0);\n";
        if (p.qualifier == Parameter::Qualifier::inout && (p.type == "float" || p.type == "double"))
            code += "    " + signature.arguments[k] + " = lb_tmax;\n";
        list += (k == 0 ? "" : ", ") + signature.arguments[k];
    }

    // Calls the function, or marches it if it is a field.
    const std::string call = signature.function.name + "(" + list + ")";
    code += signature.kind == Signature::Kind::field ? march_code(signature, march, call)
                                                     : "    " + signature.function.type + " lb_says = " + call + ";\n";

    // Stores the numbers of the answer, and whether it is a hit.
    const auto store = [&code](const std::string& near, const std::string& far) {
        code += "    lb_answers[2u * lb_i] = " + near + ";\n    lb_answers[2u * lb_i + 1u] = " + far + ";\n";
    };
    switch (signature.answers) {
        case Answers::t: store("lb_says", "lb_says"); break;
        case Answers::near_far: store("lb_says.x", "lb_says.y"); break;
        case Answers::hit: break;
        case Answers::hit_and_t: store(signature.outputs[0], signature.outputs[0]); break;
        case Answers::hit_and_near_far: store(signature.outputs[0], signature.outputs[1]); break;
    }
    const bool returns_hit = signature.function.type == "bool";
    return code + "    lb_hits[lb_i] = " + (returns_hit ? "lb_says ? 1u : 0u" : "1u") + ";\n";
}

/// The members of the buffer `head`, in the order of `KernelHead`, and the buffers of columns.
constexpr std::array<std::string_view, 4> head_members{"lb_count", "lb_stride", "lb_has_ends", "lb_has_starts"};
static_assert(sizeof(KernelHead) == head_members.size() * sizeof(std::uint32_t));
struct ColumnBuffer {
    BufferBinding binding;
    std::string_view name;
    bool is_written = false, holds_integers = false;  ///< whether the program writes the buffer; whether it
                                                      ///< holds integers in place of floating-point numbers
};
constexpr std::array<ColumnBuffer, BufferBinding::binding_count - 1> column_buffers{
    {{BufferBinding::rays, "lb_rays"},
     {BufferBinding::ends, "lb_ends"},
     {BufferBinding::primitives, "lb_primitives"},
     {BufferBinding::answers, "lb_answers", true},
     {BufferBinding::hits, "lb_hits", true, true},
     {BufferBinding::starts, "lb_starts"}}};

/// Declares the buffers and begins the main function, in GLSL.
std::string glsl_prologue(const std::string& real) {
    std::string code = "layout(local_size_x = " + std::to_string(device::group_size) + ") in;\n", head;
    const auto buffer = [&code](BufferBinding binding, bool is_written, const std::string& members) {
        code += "layout(std430, binding = " + std::to_string(binding) + ") " + (is_written ? "writeonly" : "readonly") +
                " buffer LbBuffer" + std::to_string(binding) + " {" + members + " };\n";
    };
    for (const std::string_view member : head_members) head += " uint " + std::string(member) + ";";
    buffer(BufferBinding::head, false, head);
    for (const ColumnBuffer& c : column_buffers)
        buffer(c.binding, c.is_written, " " + (c.holds_integers ? "uint" : real) + " " + std::string(c.name) + "[];");
    return code + "void main() {\n";
}

/// Declares the buffers and begins the main function, in HLSL. Its macros allow the rest of the program to be written
/// as in GLSL.
std::string hlsl_prologue() {
    std::string code =
        "#define vec2 float2\n#define vec3 float3\n#define vec4 float4\n#define uintBitsToFloat asfloat\n";
    for (std::size_t k = 0; k < head_members.size(); ++k)
        code += "#define " + std::string(head_members[k]) + " lb_head[" + std::to_string(k) + "]\n";
    const auto declare_buffer = [&code](const ColumnBuffer& buffer) {
        code += "[[vk::binding(" + std::to_string(buffer.binding) + ")]] " + (buffer.is_written ? "RW" : "") +
                "StructuredBuffer<" + (buffer.holds_integers ? "uint" : "float") + "> " + std::string(buffer.name) +
                ";\n";
    };
    declare_buffer({BufferBinding::head, "lb_head", false, true});
    for (const ColumnBuffer& c : column_buffers) declare_buffer(c);
    return code + "[numthreads(" + std::to_string(device::group_size) + ", 1, 1)] void " +
           device::entry_of(device::Language::hlsl) + "(uint3 gl_GlobalInvocationID : SV_DispatchThreadID) {\n";
}

std::string main_code(const Signature& signature, const ShaderMarch& march, bool is_hlsl) {
    const std::string real = signature.is_double ? "double" : "float", v = signature.is_double ? "dvec" : "vec";
    const std::string count = std::to_string(row_of(signature.shape).number_count);
    std::string code = is_hlsl ? hlsl_prologue() : glsl_prologue(real);
    const auto declare_vector = [&](const std::string& name, const char* array, std::size_t first) {
        code += "    " + v + "3 " + name + " = " + v + "3(";
        for (std::size_t k = 0; k < 3; ++k)
            code += std::string(k == 0 ? "" : ", ") + array + "[" + std::to_string(first + k) + "]";
        code += ");\n";
    };

    // Reads the numbers of the ray and of the primitive.
    code += "    uint lb_i = gl_GlobalInvocationID.x;\n    if (lb_i >= lb_count) return;\n";
    code += "    " + real + " lb_ray[6], lb_primitive[" + count + "];\n";
    code += "    for (uint k = 0u; k < 6u; ++k) lb_ray[k] = lb_rays[6u * lb_i + k];\n";
    code += "    for (uint k = 0u; k < " + count + "u; ++k) lb_primitive[k] = lb_primitives[lb_stride * lb_i + k];\n";
    declare_vector("lb_origin", "lb_ray", 0);
    declare_vector("lb_direction", "lb_ray", 3);
    for_each_key(signature.shape, [&](const Key& key, std::size_t k) {
        if (key.count() == 3) declare_vector("lb_" + std::string(key.name), "lb_primitive", k);
    });

    // Infinity is written by its bits, since drivers differ in what a division by zero gives.
    code +=
        "    " + real + " lb_tmax = lb_has_ends != 0u ? lb_ends[lb_i] : " + real + "(uintBitsToFloat(0x7f800000u));\n";
    code += "    " + real + " lb_tmin = lb_has_starts != 0u ? lb_starts[lb_i] : " + real + "(0);\n";
    return code + call_code(signature, march) + "}\n";
}

const std::map<std::string_view, std::string_view>& types_of_doubles() {
    static const std::map<std::string_view, std::string_view> types{
        {"float", "double"}, {"vec2", "dvec2"}, {"vec3", "dvec3"},     {"vec4", "dvec4"},     {"mat2", "dmat2"},
        {"mat3", "dmat3"},   {"mat4", "dmat4"}, {"mat2x2", "dmat2x2"}, {"mat3x3", "dmat3x3"}, {"mat4x4", "dmat4x4"}};
    return types;
}

/// Rewrites a number that has a point, an exponent or the suffix f for the other width. Other numbers stay as they are.
std::string converted_number(std::string_view number, bool to_doubles) {
    std::string text(number);
    const bool is_hex = text.starts_with("0x") || text.starts_with("0X");
    const bool is_real = !is_hex && text.find_first_of(".eEfF") != std::string::npos;
    if (!is_real) return text;
    while (text.ends_with('f') || text.ends_with('F') || text.ends_with('l') || text.ends_with('L')) text.pop_back();
    if (text.find_first_of(".eE") == std::string::npos) text += ".0";
    return to_doubles ? text + "LF" : text;
}

}  // namespace

std::string convert_precision(const std::string& text, bool to_doubles) {
    std::string result;
    std::size_t copied = 0;
    bool in_precision = false;
    for (const Token& token : split_into_tokens(text)) {
        std::string replacement(token.text);
        if (token.kind == Token::Kind::number) replacement = converted_number(token.text, to_doubles);
        if (token.kind == Token::Kind::name) {
            for (const auto& [float_type, double_type] : types_of_doubles()) {
                if (token.text == (to_doubles ? float_type : double_type))
                    replacement = to_doubles ? double_type : float_type;
            }
        }

        // `precision highp float;` has no counterpart for doubles.
        in_precision = in_precision || (to_doubles && token.text == "precision");
        result += text.substr(copied, token.offset - copied) + (in_precision ? "" : replacement);
        if (token.text == ";") in_precision = false;
        copied = token.offset + token.text.size();
    }
    return result + text.substr(copied);
}

std::pair<std::string, std::string> embeddable_text(const std::string& text) {
    const std::string code = as_compute_code(text, false);
    return {"#version 450\n" + site_declarations(code), code};
}

std::string write_program_text(const ShaderSource& shader, int bits, int version) {
    const auto line = [](int number) { return "\n#line " + std::to_string(number) + "\n"; };
    Signature signature = shader.signature;
    if (shader.is_hlsl)
        return line(1) + shader.text + line(kernel_first_line) + main_code(signature, shader.march, true);

    std::string text = as_compute_code(shader.text);
    std::string declarations = site_declarations(text);
    if (signature.is_double != (bits == 64)) {
        const bool to_doubles = bits == 64;
        text = convert_precision(text, to_doubles);
        declarations = convert_precision(declarations, to_doubles);
        for (std::string& argument : signature.arguments) argument = convert_precision(argument, to_doubles);
        for (Parameter& parameter : signature.function.parameters)
            parameter.type = convert_precision(parameter.type, to_doubles);
        signature.function.type = convert_precision(signature.function.type, to_doubles);
        signature.is_double = to_doubles;
    }
    return "#version " + std::to_string(version) + "\n" + declarations + line(1) + text + line(kernel_first_line) +
           main_code(signature, shader.march, false);
}

}  // namespace lostbits::intersect::shader
