// Names of the numbers of a primitive in tables, in files and on the command line. All of them follow from the keys.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "shapes/primitive.hpp"

namespace lostbits {

/// The names of the numbers of a primitive in tables, in their order: centre_x, …, radius.
std::span<const std::string> number_names(Shape shape);

/// The short names in files of rays: cx, …, radius.
std::span<const std::string> column_names(Shape shape);

/// The other names of number `k` that files of rays may use: centre_x, center_x; r.
std::vector<std::string> other_column_names(Shape shape, std::size_t k);

/// "a sphere", "an ellipsoid".
std::string with_article(Shape shape);

/// The paths of the numbers in files: sphere.centre.x, …, sphere.radius.
std::vector<std::string> number_paths(Shape shape);

/// The placeholder of an option that takes all numbers at once: CX,CY,CZ,R.
std::string option_placeholder(Shape shape);

/// "centre and radius"
std::string key_phrase(Shape shape);

/// "centre, radius"
std::string key_list(Shape shape);

/// "lo <= hi", for a key that must be at least the key before it.
std::string order_phrase(const Key& key);

/// Says why a ray cannot have an end if the forms of the shape do not take tmax.
std::string no_end_reason(Shape shape);

/// Says how a key's limit is broken, as the end of a sentence about the key: "is not greater than 0; …".
std::string limit_phrase(Shape shape, const Key& key);

}  // namespace lostbits
