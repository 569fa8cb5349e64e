// Arguments and answer of a shader function, found from its types, and from its names if the types leave it open.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intersect/shader/reading.hpp"
#include "shapes/solid.hpp"

namespace lostbits::intersect::shader {

/// How a function that is an intersector is called. Expressions name what the program around it declares: `lb_origin`,
/// `lb_direction`, `lb_point`, `lb_solid[k]` (k-th number of the solid), `lb_tmin` and `lb_tmax`.
struct Signature {
    /// What the function is: of a ray and a solid; of a ray alone, which meets solids of its own; or a field of
    /// distances (of a point), which the program around it marches through. The first is meant where a file has
    /// several.
    enum class Kind { intersector, march, field };
    enum class Answers { t, near_far, hit, hit_and_t, hit_and_near_far };

    Function function;
    Kind kind = Kind::intersector;
    Shape shape{};
    Answers answers = Answers::t;
    bool doubles = false;                ///< written in dvec3 and double
    bool knows_start = false;            ///< is told where the ray begins
    bool knows_end = false;              ///< is told where the ray ends
    std::vector<std::string> arguments;  ///< expressions; `lb_out_k` for what it writes, k its place among all
    std::vector<std::string> outputs;    ///< those of `arguments` that hold t, or near and far
};

/// Nothing if the types are not those of an intersector. A march and a field must have a name that says so, `march` or
/// `map`, unless the user named the function.
std::optional<Signature> signature_of(const Function& function, bool named = false);

/// Description of the recognised signatures, for messages.
extern const std::string_view known_signatures;

}  // namespace lostbits::intersect::shader
