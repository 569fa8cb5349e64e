// Lengths that a format cannot hold: what rounds to 0 or to infinity before any form has computed anything.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/rays/rays.hpp"

namespace lostbits::scene::rays {

/// Gathers what a format makes of lengths, a line for each kind of loss: "radius = 1e-09 rounds to 0 (sphere 2; 3 in
/// all)". A form is given them all the same: what it makes of them is for the measurement to say.
///
/// Of a sphere it is lost when the radius rounds to 0 or to infinity, of a box when two corners that differ in a
/// coordinate become one number there, and of any point when a coordinate rounds to infinity. (A coordinate that rounds
/// to 0 is near the origin still: what that moves is input error like any other rounding.)
class LostLengths {
public:
    /// Names the solid, or the place where it is met; asked for only where something is lost.
    using Where = std::function<std::string()>;

    explicit LostLengths(const FloatFormat& format) : format_(format) {}

    /// `before` as stored, each number then rounded to the format. What is lost at one place counts once.
    void add(const Solid<double>& before, const Where& where);
    /// The same, where `after` is what the format has of it.
    void add(const Solid<double>& before, const Solid<double>& after, const Where& where);
    void add_point(const Vec<double>& before, const char* what, const Where& where);

    /// Any other number, lost at 0 and at infinity.
    void add_number(double before, const std::string& what, const Where& where);

    [[nodiscard]] std::vector<std::string> lines() const;

private:
    struct Loss {
        std::string what, becomes;
        double value;
        std::string first, last;  ///< places
        int count;
    };
    void lose(const std::string& what, double value, const char* becomes, const Where& where);
    void check_point(const double* before, const double* after, const std::string& what, const Where& where);

    FloatFormat format_;
    std::vector<Loss> losses_;
};

/// Of a scene's eye and solids. Shared inputs are binary32 numbers before the format sees them.
std::vector<std::string> lost_lengths(const file::Scene& scene, const FloatFormat& f);

}  // namespace lostbits::scene::rays
