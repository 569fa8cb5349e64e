// Composed forms: forms with the rays of a ray generator, in the table of intersectors, and the names of all composed
// forms.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "intersect/bounding_box/behind.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "scene/camera/ray_generators.hpp"

namespace lostbits::scene::rays {

/// The prefix between the form and the ray generator: `sphere.unified@ray-three`.
inline constexpr std::string_view generator_prefix = "ray-";

/// The end of the name of a form whose products are contracted: `sphere.schoolbook+fma`.
inline constexpr std::string_view contracted_suffix = "+fma";

/// Returns the form `sphere.unified@ray-three`: the form itself, with rays from the ray generator `three`. The form is
/// made by the first call and stored. Throws InputError for sets, and for forms in the space of primitives with
/// transforms; a scene with `camera.rays` can be used for these.
const intersect::table::Intersector& with_generator(const camera::RayGenerator& generator,
                                                    const intersect::table::Intersector& form);

/// Returns null if the form has no ray generator of its own.
const camera::RayGenerator* generator_of(const intersect::table::Intersector& form);

/// Returns the form without its ray generator, or the form itself if it has none.
const intersect::table::Intersector& strip_generator(const intersect::table::Intersector& form);

/// Returns the form itself, to be made part of another form. Throws InputError if the form has a ray generator, which
/// must come last in a name, as in `FORM^BOX@ray-METHOD`.
const intersect::table::Intersector& require_no_generator(const intersect::table::Intersector& form);

/// Returns the forms in a set's name, `sphere.unified+fma+box.signs`. The name is split at each + except that of
/// `+fma`. A name of one form is not a set.
std::vector<std::string> forms_in_name(const std::string& name);

/// A name of a composed form, split before its last part: FORM@TRANSFORM, FORM@ray-METHOD, FORM^BOX, FORM^BOX~METHOD or
/// FORM+fma.
struct ComposedName {
    enum class Kind { transform, generator, box, contracted } kind;
    std::string form;                       ///< may itself be the name of a composed form
    std::string last;                       ///< the transform, the ray generator, or the form of boxes; "fma"
    std::optional<std::string> box_method;  ///< the method to compute the bounding box, if one is named
};
/// Returns nothing for a name that neither contains an @ or a ^ nor ends with +fma.
std::optional<ComposedName> split_composed_name(const std::string& name);

/// Functions that find the parts with a given name: one part for a name, several for a glob. They throw for unknown
/// names.
struct NamedParts {
    template <class Part>
    using Find = std::function<std::vector<const Part*>(const std::string&)>;
    Find<intersect::table::Intersector> forms;
    Find<intersect::transform::TransformMethod> transform_methods;
    Find<camera::RayGenerator> ray_generators;
    Find<intersect::bounding_box::BoxMethod> box_methods;
    /// Returns the form of a form whose products are contracted.
    std::function<const intersect::table::Intersector&(const intersect::table::Intersector&)> contracted;
};
/// Returns every form with this name, ordered by the form, then the box, then the other part.
std::vector<const intersect::table::Intersector*> rows_of(const ComposedName& name, const NamedParts& parts);

}  // namespace lostbits::scene::rays
