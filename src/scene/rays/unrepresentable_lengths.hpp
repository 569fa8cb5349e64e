// Finds lengths that a format cannot hold: they round to 0 or to infinity before any form has computed anything.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/rays/rays.hpp"

namespace lostbits::scene::rays {

/// Collects the lengths that a format loses, with a line for each kind of loss: "radius = 1e-09 rounds to 0 (sphere 2;
/// 3 in all)". A form receives these lengths anyway, and the measurement shows what the form makes of them.
///
/// A sphere is lost if its radius rounds to 0 or to infinity, and a box if two corners that differ in a coordinate
/// become equal in this coordinate. Any point is lost if a coordinate rounds to infinity. (A coordinate that rounds to
/// 0 is still near the origin: that move is input error like any other rounding.)
class UnrepresentableLengths {
public:
    /// Names the primitive, or the position of the loss; called only if something is lost.
    using DescribePosition = std::function<std::string()>;

    explicit UnrepresentableLengths(const FloatFormat& format) : format_(format) {}

    /// Adds a stored primitive, whose numbers are then rounded to the format. Losses at one position count once.
    void add(const Primitive<double>& before, const DescribePosition& where);
    /// Adds a stored primitive `before` that is `after` in the format.
    void add(const Primitive<double>& before, const Primitive<double>& after, const DescribePosition& where);
    void add_point(const Vec<double>& before, const char* what, const DescribePosition& where);

    /// Adds any other number, which is lost if it rounds to 0 or to infinity.
    void add_number(double before, const std::string& what, const DescribePosition& where);

    [[nodiscard]] std::vector<std::string> lines() const;

private:
    struct UnrepresentableLength {
        std::string what, becomes;
        double value;
        std::string first, last;  ///< positions
        int count;
    };
    void add_length(const std::string& what, double value, const char* becomes, const DescribePosition& where);
    void check_point(const double* before, const double* after, const std::string& what, const DescribePosition& where);

    FloatFormat format_;
    std::vector<UnrepresentableLength> losses_;
};

/// The losses of a scene's eye and primitives. Shared inputs are binary32 numbers before the format sees them.
std::vector<std::string> find_unrepresentable_lengths(const file::Scene& scene, const FloatFormat& format);

}  // namespace lostbits::scene::rays
