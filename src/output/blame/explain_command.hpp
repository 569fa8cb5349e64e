// The command line that explains a ray which a file names.
#pragma once

#include <string>
#include <string_view>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::output::blame {

/// A word as a shell reads it back: in single quotes where it holds more than letters, digits and _./=,:+-.
std::string shell_word(std::string_view word);

/// `near-benign --pixel 3,4`: a pixel of what `scene` names, a word of the command line and perhaps options after it.
std::string name_of_pixel(const std::string& scene, int x, int y);

/// `--sphere=0,0,5,2 --ray=…`: a ray with its solids, every number exact; with its end and the constants of the march,
/// where it has them. Empty for no ray.
std::string name_of_ray(const scene::rays::RayGroup* one);

/// What a command needs that asks for forms from outside (` --plugin ./mine.so`): set once, before any is made.
void say_where_forms_are_from(const std::string& words);
/// The same words; empty where all forms are the catalogue's.
[[nodiscard]] const std::string& where_forms_are_from();

/// The same words where a form of that name is not the catalogue's; else nothing.
[[nodiscard]] std::string where_form_is_from(std::string_view form);

/// `lostbits explain NAME -i FORM -f FORMAT`, with the convention that the row is judged by unless that is its own, and
/// with where a form from outside is from. Empty for the answers of a file, which nobody can ask again.
std::string explain_command(const std::string& name, const measure::evaluate::TestedForm& row);

}  // namespace lostbits::output::blame
