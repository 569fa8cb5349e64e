// What the numbers of a solid are called: in tables, in files, on the command line. All of it follows from the keys.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "shapes/solid.hpp"

namespace lostbits {

/// The names of a solid's numbers, in their order, as tables have them: centre_x, …, radius.
std::span<const std::string> number_names(Shape shape);

/// The same short, as files of rays have them: cx, …, radius.
std::span<const std::string> column_names(Shape shape);

/// Other names of number `k` in files of rays: centre_x, center_x; r.
std::vector<std::string> other_column_names(Shape shape, std::size_t k);

/// "a sphere", "an ellipsoid".
std::string with_article(Shape shape);

/// The paths of the numbers in files: sphere.centre.x, …, sphere.radius.
std::vector<std::string> number_paths(Shape shape);

/// What an option for all numbers at once asks for: CX,CY,CZ,R.
std::string option_words(Shape shape);

/// "centre and radius"
std::string key_words(Shape shape);

/// "centre, radius"
std::string key_list(Shape shape);

/// "lo <= hi", of a key that is at least the one before it.
std::string order_words(const Key& key);

/// What is wrong with the end of a ray where the forms of a shape are not told of it.
std::string no_end_words(Shape shape);

/// What is wrong where a key's limit is broken, as the end of a sentence about the key: "is not greater than 0; …".
std::string limit_words(Shape shape, const Key& key);

}  // namespace lostbits
