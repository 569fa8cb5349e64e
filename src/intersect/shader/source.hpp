// A GLSL or HLSL file with one intersector in it, and its contract.
#pragma once

#include <string>
#include <vector>

#include "intersect/external/contract.hpp"
#include "intersect/shader/reading.hpp"
#include "intersect/shader/signature.hpp"

namespace lostbits::intersect::shader {

/// The answers by which a function that returns only numbers reports a miss.
struct MissSentinel {
    enum class Kind {
        negative,  ///< t < 0; for near and far, far < 0
        crossed,   ///< near > far, or far < 0
        zero,      ///< t ≤ 0
        infinite,  ///< not finite
        above      ///< t ≥ `bound`
    };
    Kind kind = Kind::negative;
    double bound = 0;

    /// True if these numbers mean a miss; for a function that returns one number t, pass t as both. NaN means a miss
    /// only for `infinite`; for the other kinds, it is a hit at NaN.
    [[nodiscard]] bool means_miss(double near, double far) const;
};

/// Constants of the loop that marches a field: d = map(ro + rd t); a hit at that t if d < hit_eps; else t += d; a miss
/// if t > max_dist, or after max_steps. The defaults are those of lesson P0-C1 of SDF Sphere Marching.
struct ShaderMarch {
    double hit_eps = 0.001, max_dist = 20;
    int max_steps = 64;
};

struct ShaderSource {
    std::string path, text;
    Signature signature;
    external::Contract contract;  ///< `bits` is the number of bits of the file's floating-point type
    MissSentinel miss_sentinel;
    ShaderMarch march;  ///< used only for a field
    /// True for each requested format. If the file is written for the other format, it is rewritten for this one.
    bool f32 = true, f64 = false;
    bool is_hlsl = false;  ///< true if the file name ends in .hlsl; such a shader computes only in floats
    std::vector<CountedLoop> loops;
};

/// Reads `FILE.glsl` or `FILE.glsl:OPTIONS`. The options, separated by commas, are a function's name and properties
/// `key=value`. Comments of the file may also state properties (`// lostbits: roots=first touching=miss`); properties
/// of the command line take precedence. Throws InputError with the position if the file has no intersector or several,
/// or for an invalid option.
ShaderSource read_shader(const std::string& argument);

}  // namespace lostbits::intersect::shader
