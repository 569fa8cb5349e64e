// A GLSL or HLSL file with one intersector in it, and its contract.
#pragma once

#include <string>
#include <vector>

#include "intersect/doors/contract.hpp"
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

/// The usual loop through a field: d = map(ro + rd t); a hit where d < hit_eps, at that t; t += d; a miss where
/// t > max_dist, and after max_steps. Defaults are those of SDF Sphere Marching (lesson P0-C1).
struct MarchWords {
    double hit_eps = 0.001, max_dist = 20;
    int max_steps = 64;
};

struct ShaderSource {
    std::string path, text;
    Signature signature;
    doors::Contract contract;  ///< its `bits` are those that the file is written in
    Sentinel sentinel;
    MarchWords march;              ///< of a field
    bool f32 = true, f64 = false;  ///< what is asked for; a file of the one is rewritten for the other
    bool hlsl = false;             ///< by the end of its name, .hlsl; in floats alone
    std::vector<CountedLoop> loops;
};

/// `FILE.glsl`, or `FILE.glsl:WORDS` where WORDS, with commas between them, are a function's name and `key=value` as in
/// comments of the file (`// lostbits: roots=first touching=miss`); those of the command line win. InputError with the
/// place, for a file without an intersector or with several, and for words that make no sense.
ShaderSource read_shader(const std::string& named);

}  // namespace lostbits::intersect::shader
