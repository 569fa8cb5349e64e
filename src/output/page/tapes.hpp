// What the page needs to run the operations of any of its rays again: the camera, the solids and the tapes of the
// forms.
#pragma once

#include <set>

#include "intersect/table/table.hpp"
#include "output/page/json.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::output::page {

/// `scene::CameraFrame` of double, or of Real where the scene's inputs are its own, number by number and exactly.
[[nodiscard]] Json camera_json(const scene::file::Scene& scene);

/// `{"0":[…],…}`: the numbers, exactly, of the solids named by their places in the scene. A sphereflake has more than a
/// page should hold.
[[nodiscard]] Json solids_json(const scene::file::Scene& scene, const std::set<int>& places);

/// The tape of a form that does not march, which is the same for every ray but for the numbers on it: operations with
/// the places of their formats and operands, and their texts as `lostbits explain` writes them; and of what kind each
/// operation is that any tape can have.
[[nodiscard]] Json tape_json(const intersect::table::Intersector& form, const Format& format);

}  // namespace lostbits::output::page
