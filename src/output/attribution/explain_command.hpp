// Builds the `explain` commands that result files give for a ray.
#pragma once

#include <string>
#include <string_view>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::output::attribution {

/// Arguments of `explain` for pixel (x, y) of a scene: `near-benign --pixel 3,4`. `scene` is an argument quoted for a
/// shell, possibly with options after it.
std::string explain_pixel_arguments(const std::string& scene, int x, int y);

/// Arguments of `explain` for the first ray of a group and its primitives: `--sphere=0,0,5,2 --ray=…`, with exact
/// numbers, the ends of the ray's range, and the constants of a march. Empty if `group` is null.
std::string explain_ray_arguments(const scene::rays::RayGroup* group);

/// Sets the options that a command needs for external forms (` --plugin ./mine.so`). Call it once, before any command
/// is built.
void set_plugin_options(const std::string& options);
/// Options set by `set_plugin_options`; empty if all forms belong to the catalogue.
[[nodiscard]] const std::string& plugin_options();

/// `plugin_options()` if the form of this name is external; otherwise empty.
[[nodiscard]] std::string plugin_options_for(std::string_view form);

/// Command `lostbits explain ARGUMENTS -i FORM -f FORMAT`. It also has the convention that judges the form, if that is
/// not the form's own, and the options for an external form. Empty for the answers of a file, which cannot be computed
/// again.
std::string explain_command(const std::string& arguments, const measure::evaluate::TestedForm& tested_form);

}  // namespace lostbits::output::attribution
