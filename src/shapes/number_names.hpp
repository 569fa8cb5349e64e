// Names of the numbers of a primitive in tables, in files and on the command line. They are derived from the keys of
// the shape.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "shapes/primitive.hpp"

namespace lostbits {

/// Returns the names of the numbers of a primitive in tables, in order: centre_x, …, radius.
std::span<const std::string> number_names(Shape shape);

/// Returns the short names in files of rays: cx, …, radius.
std::span<const std::string> column_names(Shape shape);

/// Returns the other names that files of rays may use for the number at index `k`: centre_x, center_x; r.
std::vector<std::string> other_column_names(Shape shape, std::size_t k);

/// Returns the name with its article: "a sphere", "an ellipsoid".
std::string with_article(Shape shape);

/// Returns the paths of the numbers in files: sphere.centre.x, …, sphere.radius.
std::vector<std::string> number_paths(Shape shape);

/// Returns the placeholder of an option that takes all numbers at once: CX,CY,CZ,R.
std::string option_placeholder(Shape shape);

/// Returns the keys as a phrase: "centre and radius".
std::string key_phrase(Shape shape);

/// Returns the keys as a list: "centre, radius".
std::string key_list(Shape shape);

/// Returns the required order, "lo <= hi", of a key that must be at least the key before it.
std::string order_phrase(const Key& key);

/// Returns the reason why a ray cannot have an end, for a shape whose forms do not take tmax.
std::string no_end_reason(Shape shape);

/// Returns how a primitive breaks a limit, as the rest of a sentence about the key: "is not greater than 0; …".
std::string limit_phrase(Shape shape, const BrokenLimit& broken);

}  // namespace lostbits
