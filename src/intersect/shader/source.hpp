// A GLSL or HLSL file with one intersector in it, and its contract.
#pragma once

#include <string>
#include <vector>

#include "intersect/external/contract.hpp"
#include "intersect/shader/reading.hpp"
#include "intersect/shader/signature.hpp"

namespace lostbits::intersect::shader {

/// The answer for a miss of a function that returns only numbers.
struct Sentinel {
    enum class Kind {
        negative,  ///< t < 0; of near and far, far < 0
        crossed,   ///< near > far, or far < 0
        zero,      ///< t ≤ 0
        infinite,  ///< not finite
        above      ///< t ≥ `bound`
    };
    Kind kind = Kind::negative;
    double bound = 0;

    /// True if these numbers mean a miss; for a function of one number, pass `t` twice. A NaN is a miss for `infinite`
    /// alone: otherwise a hit at NaN is an answer too.
    [[nodiscard]] bool says_miss(double near, double far) const;
};

/// Constants of the usual loop through a field: d = map(ro + rd t); a hit at that t if d < hit_eps; else t += d; a miss
/// if t > max_dist, or after max_steps. The defaults are those of SDF Sphere Marching (lesson P0-C1).
struct ShaderMarch {
    double hit_eps = 0.001, max_dist = 20;
    int max_steps = 64;
};

struct ShaderSource {
    std::string path, text;
    Signature signature;
    external::Contract contract;  ///< its `bits` are those of the numbers in the file
    Sentinel sentinel;
    ShaderMarch march;             ///< used for a field
    bool f32 = true, f64 = false;  ///< formats wanted; the file is rewritten for the one that it is not in
    bool hlsl = false;             ///< if its name ends in .hlsl; computes in floats only
    std::vector<CountedLoop> loops;
};

/// Reads `FILE.glsl` or `FILE.glsl:OPTIONS`. The options, with commas between them, are a function's name and
/// properties `key=value`, which comments of the file may state too (`// lostbits: roots=first touching=miss`). Those
/// of the command line take precedence. InputError with the position if the file has no intersector or several, or for
/// an invalid option.
ShaderSource read_shader(const std::string& named);

}  // namespace lostbits::intersect::shader
