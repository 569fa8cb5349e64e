// Readers for the tables of a scene file. They throw InputError with a position for anything that cannot be a picture.
// They also check that numbers survive rounding to binary32 if inputs are shared.
#pragma once

#include <cmath>
#include <optional>
#include <string_view>

#include "number/real.hpp"
#include "scene/file/scene.hpp"
#include "scene/toml/round.hpp"
#include "scene/toml/toml_reader.hpp"
#include "shapes/transform.hpp"

namespace lostbits::scene::file {

/// Checks the numbers of a file. Each of `require_finite` and `require_positive` returns the number of `key`, or fails
/// with the position of `key`.
class StoredNumbers {
public:
    explicit StoredNumbers(InputRounding inputs) : are_inputs_shared_(inputs == InputRounding::shared) {}

    static constexpr std::string_view overflow_words =
        "overflows binary32, to which inputs = \"shared\" rounds; write at most 3.4e38, or inputs = \"own\"";

    [[nodiscard]] bool overflows(const Real& x) const {
        return are_inputs_shared_ && std::isinf(toml::round_to_format(x, binary32));
    }

    Real require_finite(const toml::TableReader& table, std::string_view key, const Real& x) const {
        if (overflows(x)) table.fail_at(key, std::string(overflow_words));
        return x;
    }

    [[nodiscard]] Vec<Real> require_finite(const toml::TableReader& table, std::string_view key,
                                           const Vec<Real>& v) const {
        return {require_finite(table, key, v.x), require_finite(table, key, v.y), require_finite(table, key, v.z)};
    }

    [[nodiscard]] Real round_as_stored(const Real& x) const {
        return are_inputs_shared_ ? Real(toml::round_to_format(x, binary32)) : x;
    }

    /// True if the number is zero, or if it is zero once rounded to binary32 for shared inputs.
    [[nodiscard]] bool is_stored_as_zero(const Real& x) const {
        return x == 0 || (are_inputs_shared_ && toml::round_to_format(x, binary32) == 0);
    }

    Real require_positive(const toml::TableReader& table, std::string_view key, const Real& x) const {
        if (x <= 0) table.fail_at(key, "must be greater than 0; write a positive number");
        if (are_inputs_shared_ && toml::round_to_format(x, binary32) == 0)
            table.fail_at(key,
                          "becomes 0 in binary32, to which inputs = \"shared\" rounds; write at least 1.5e-45, or "
                          "inputs = \"own\"");
        return require_finite(table, key, x);
    }

private:
    bool are_inputs_shared_;
};

/// Reads `[camera]`.
Camera read_camera(toml::TableReader table, const StoredNumbers& numbers);

/// Reads the keys of the file itself: `background`, `[light]`, `[shadows]`, `[material]`. `read_material` reads the
/// materials, one by one.
Appearance read_appearance(toml::TableReader& file, const StoredNumbers& numbers);

/// Reads the keys of a sphere's paint. A missing key has the value of `appearance.base`.
Material read_material(toml::TableReader& sphere, const Appearance& appearance, const StoredNumbers& numbers);

/// Reads the table `transform` of a primitive, if it has one: `matrix` (twelve numbers, row by row), or `scale`,
/// `rotate`, `translate` and `look_at`, applied in this order, or `steps`, a list of such tables applied one after the
/// other. They are composed in the scene's exact numbers, and rounded once when stored: as the matrix from the
/// primitive to the world or, with `stored = "inverse"`, as its inverse. Throws InputError with a position, also if the
/// matrix is singular, as written or as stored.
std::optional<Transform<Real>> read_transform(toml::TableReader& primitive, const StoredNumbers& numbers);

}  // namespace lostbits::scene::file
