// Command lines that explain a ray named in a file.
#pragma once

#include <string>
#include <string_view>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::output::attribution {

/// A word as a shell reads it back: in single quotes if it holds more than letters, digits and _./=,:+-.
std::string shell_word(std::string_view word);

/// `near-benign --pixel 3,4`: a pixel of `scene`, which is a word of the command line and perhaps options after it.
std::string name_of_pixel(const std::string& scene, int x, int y);

/// `--sphere=0,0,5,2 --ray=…`: a ray with its primitives, every number exact, with its end and the constants of the
/// march if it has them. Empty for no ray.
std::string name_of_ray(const scene::rays::RayGroup* one);

/// Options that a command needs for forms from outside (` --plugin ./mine.so`). Set once, before any command is made.
void set_plugin_options(const std::string& words);
/// The same options; empty if all forms are the catalogue's.
[[nodiscard]] const std::string& plugin_options();

/// The same options if a form of that name is not the catalogue's; otherwise empty.
[[nodiscard]] std::string plugin_options_for(std::string_view form);

/// `lostbits explain NAME -i FORM -f FORMAT`, with the convention that judges the row if it is not the form's own, and
/// the options for a form from outside. Empty for the answers of a file, which cannot be asked again.
std::string explain_command(const std::string& name, const measure::evaluate::TestedForm& row);

}  // namespace lostbits::output::attribution
