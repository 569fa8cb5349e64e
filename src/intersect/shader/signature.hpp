// The arguments and the answer of a shader function, found from its types, and from its names if the types leave
// several choices.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intersect/shader/reading.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::intersect::shader {

/// The call of a function that is an intersector. The expressions of the call use names that the surrounding program
/// declares: `lb_origin`, `lb_direction`, `lb_point`, `lb_primitive[k]` (number k of the primitive), `lb_tmin` and
/// `lb_tmax`.
struct Signature {
    /// `intersector` takes a ray and a primitive; `march` takes only a ray, and its primitives are in the file; `field`
    /// takes a point and returns a distance, and the program around it marches. If a file has functions of several
    /// kinds, those of the first kind in this list are used.
    enum class Kind { intersector, march, field };
    /// The numbers and decisions that the function yields.
    enum class Answers { t, near_far, hit, hit_and_t, hit_and_near_far };

    Function function;
    Kind kind = Kind::intersector;
    Shape shape{};
    Answers answers = Answers::t;
    bool is_double = false;              ///< true if the function is written in dvec3 and double
    bool takes_start = false;            ///< true if the function takes the beginning of the ray
    bool takes_end = false;              ///< true if the function takes the end of the ray
    std::vector<std::string> arguments;  ///< expressions; `lb_out_k` for the output parameter k
    std::vector<std::string> outputs;    ///< the expressions in `arguments` that hold t, or near and far
};

/// Returns the signature of a function; empty if its types do not fit an intersector. A march and a field must
/// have a name such as `march` or `map`, unless the user named the function.
std::optional<Signature> read_signature(const Function& function, bool is_named_by_user = false);

/// Description of the recognised signatures, for messages.
extern const std::string_view known_signatures;

}  // namespace lostbits::intersect::shader
