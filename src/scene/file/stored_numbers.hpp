// The numbers of a scene file, held against what the scene does with them: rounding to binary32 where inputs are
// shared.
#pragma once

#include <cmath>
#include <string_view>

#include "scene/file/scene.hpp"
#include "scene/toml/round.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::file {

/// Each returns the number that stands at `key`, or fails there.
class StoredNumbers {
public:
    explicit StoredNumbers(Inputs inputs) : shared_(inputs == Inputs::shared) {}

    Real finite(const toml::TableReader& table, std::string_view key, const Real& x) const {
        if (shared_ && std::isinf(toml::round_to_format(x, binary32)))
            table.fail_at(
                key,
                "overflows binary32, to which inputs = \"shared\" rounds; write at most 3.4e38, or inputs = \"own\"");
        return x;
    }

    [[nodiscard]] Vec<Real> finite(const toml::TableReader& table, std::string_view key, const Vec<Real>& v) const {
        return {finite(table, key, v.x), finite(table, key, v.y), finite(table, key, v.z)};
    }

    [[nodiscard]] Real stored(const Real& x) const { return shared_ ? Real(toml::round_to_format(x, binary32)) : x; }

    /// Zero, or zero once rounded.
    [[nodiscard]] bool vanishes(const Real& x) const {
        return x == 0 || (shared_ && toml::round_to_format(x, binary32) == 0);
    }

    Real positive(const toml::TableReader& table, std::string_view key, const Real& x) const {
        if (x <= 0) table.fail_at(key, "must be greater than 0; write a positive number");
        if (shared_ && toml::round_to_format(x, binary32) == 0)
            table.fail_at(key,
                          "becomes 0 in binary32, to which inputs = \"shared\" rounds; write at least 1.5e-45, or "
                          "inputs = \"own\"");
        return finite(table, key, x);
    }

private:
    bool shared_;
};

}  // namespace lostbits::scene::file
