// Forms that are given the rays of a camera as a way makes them, as rows of the table.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "intersect/hull/behind.hpp"
#include "intersect/space/spaced.hpp"
#include "scene/camera/makers.hpp"

namespace lostbits::scene::rays {

/// What a name has between the form and the way: `sphere.unified@ray-three`.
inline constexpr std::string_view maker_prefix = "ray-";

/// What the name of a form ends with whose products are contracted: `sphere.schoolbook+fma`.
inline constexpr std::string_view contracted_suffix = "+fma";

/// The row `sphere.unified@ray-three`: the form itself, asked about rays made that way. Made once and kept. InputError
/// for sets, and for forms through the space of solids under matrices, which a scene with `camera.rays` asks.
const intersect::table::Intersector& with_maker(const camera::Maker& maker, const intersect::table::Intersector& form);

/// Null where the scene says who makes the rays.
const camera::Maker* maker_of(const intersect::table::Intersector& row);

/// The row that the way was put behind; the row itself where none was.
const intersect::table::Intersector& beneath_maker(const intersect::table::Intersector& row);

/// The row itself, to be made part of another one. InputError where its rays are made already: the way stands last, as
/// in `FORM^BOX@ray-WAY`.
const intersect::table::Intersector& without_maker(const intersect::table::Intersector& row);

/// The forms of a set's name, `sphere.unified+fma+box.signs`: it parts at each + but those of `+fma`. One: no set.
std::vector<std::string> forms_in_name(const std::string& name);

/// A name that says what a row is made of, taken apart where the last part begins: FORM@SPACE, FORM@ray-WAY, FORM^BOX,
/// FORM^BOX~HULL or FORM+fma.
struct MadeName {
    enum class Kind { space, maker, box, contracted } kind;
    std::string form;                 ///< may be such a name itself
    std::string last;                 ///< the space, the way, or the form of boxes; "fma"
    std::optional<std::string> hull;  ///< the way of computing the box, where one is named
};
/// Nothing for a name without an @ or a ^ that does not end with +fma.
std::optional<MadeName> made_name(const std::string& name);

/// What each part of a name stands for: one for a name, several for a glob. They throw for what is unknown.
struct NamedParts {
    template <class Part>
    using Find = std::function<std::vector<const Part*>(const std::string&)>;
    Find<intersect::table::Intersector> forms;
    Find<intersect::space::Space> spaces;
    Find<camera::Maker> makers;
    Find<intersect::hull::HullWay> hulls;
    /// The row of a form whose products are contracted.
    std::function<const intersect::table::Intersector&(const intersect::table::Intersector&)> contracted;
};
/// Every row of that name, the form first, then the box, then the other part.
std::vector<const intersect::table::Intersector*> rows_of(const MadeName& name, const NamedParts& parts);

}  // namespace lostbits::scene::rays
