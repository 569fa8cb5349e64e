// The functions that a GLSL file defines, as its tokens show them.
#pragma once

#include <string>
#include <vector>

#include "intersect/shader/tokens.hpp"

namespace lostbits::intersect::shader {

struct Parameter {
    enum class Way { in, out, inout };
    Way way = Way::in;
    std::string type;  ///< `vec3`; with brackets where it is an array
    std::string name;  ///< empty where it has none
};

struct Function {
    std::string type, name;
    std::vector<Parameter> parameters;
    std::size_t line = 0, column = 0;  ///< of its name

    /// `float sphere(vec3 ro, vec3 rd, vec4 s)`
    [[nodiscard]] std::string words() const;
};

/// Every function with a body, in the order of the file. `code` is what `code_tokens` gives.
std::vector<Function> functions_of(const std::vector<Token>& code);

}  // namespace lostbits::intersect::shader
