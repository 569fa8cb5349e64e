#include "scene/rays/unrepresentable_lengths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "number/real.hpp"
#include "number/rounded.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::scene::rays {

void UnrepresentableLengths::add_length(const std::string& what, double value, const char* becomes,
                                        const DescribePosition& where) {
    const auto is_same_loss = [&](const UnrepresentableLength& loss) {
        return loss.what == what && loss.becomes == becomes;
    };
    const auto known_loss = std::ranges::find_if(losses_, is_same_loss);
    const std::string position = where();
    if (known_loss == losses_.end()) {
        losses_.push_back({what, becomes, value, position, position, 1});
    } else if (known_loss->last != position) {
        known_loss->last = position;
        ++known_loss->count;
    }
}

void UnrepresentableLengths::check_point(const double* before, const double* after, const std::string& what,
                                         const DescribePosition& where) {
    for (int k = 0; k < 3; ++k) {
        if (!std::isinf(after[k])) continue;
        add_length(what, before[k], "rounds to infinity", where);
        return;
    }
}

void UnrepresentableLengths::add_point(const Vec<double>& before, const char* what, const DescribePosition& where) {
    const double coordinates[] = {before.x, before.y, before.z};
    double rounded[3];
    for (int k = 0; k < 3; ++k) rounded[k] = rounding::to_format(coordinates[k], 0, format_);
    check_point(coordinates, rounded, what, where);
}

void UnrepresentableLengths::add_number(double before, const std::string& what, const DescribePosition& where) {
    const double after = rounding::to_format(before, 0, format_);
    if (before != 0 && after == 0) add_length(what, before, "rounds to 0", where);
    if (std::isinf(after)) add_length(what, before, "rounds to infinity", where);
}

void UnrepresentableLengths::add(const Primitive<double>& before, const DescribePosition& where) {
    add(before, round_primitive(before, format_), where);
}

void UnrepresentableLengths::add(const Primitive<double>& before, const Primitive<double>& after,
                                 const DescribePosition& where) {
    const auto numbers_begin = [](const Primitive<double>& primitive) { return primitive.numbers.data(); };
    for_each_key(before.shape, [&](const Key& key, std::size_t k) {
        const double *const stored = numbers_begin(before) + k, *const rounded = numbers_begin(after) + k;
        for (std::size_t i = 0; key.is_length() && i < key.count(); ++i) {
            // A positive ideal length may already be 0 in binary64.
            if (rounded[i] == 0 && (stored[i] != 0 || key.limit == Key::Limit::positive))
                add_length(std::string(key.name), stored[i], "rounds to 0", where);
            if (std::isinf(rounded[i])) add_length(std::string(key.name), stored[i], "rounds to infinity", where);
        }

        // A primitive with two corners loses its thickness if they become equal.
        for (std::size_t i = 0; key.limit == Key::Limit::at_least_previous && i < key.count(); ++i) {
            const std::size_t count = key.count();
            const double thickness = stored[i] - (stored - count)[i];
            if (!(thickness > 0) || rounded[i] != (rounded - count)[i] || std::isinf(rounded[i])) continue;
            add_length("thickness", thickness, "rounds to 0", where);
            break;
        }
    });

    // Points are lost if two of them become equal, or a coordinate does not fit into the format.
    for_each_key(before.shape, [&](const Key& key, std::size_t k) {
        if (key.limit == Key::Limit::differs_from_previous && after.point(k) == after.point(k - 3))
            add_length("the distance to " + std::string(key.name),
                       length(Vec<double>(before.point(k) - before.point(k - 3))), "rounds to 0", where);
        if (!key.is_length())
            check_point(numbers_begin(before) + k, numbers_begin(after) + k,
                        fmt::format("a coordinate of {}", key.name), where);
    });
}

std::vector<std::string> UnrepresentableLengths::lines() const {
    std::vector<std::string> lines;
    for (const UnrepresentableLength& loss : losses_) {
        // A nonzero ideal number may be 0 in a double. A number that is 0 itself is never lost.
        const std::string size = loss.value == 0 ? "less than 5e-324" : fmt::format("= {:g}", loss.value);
        const std::string count_text = loss.count > 1 ? fmt::format("; {} in all", loss.count) : "";
        lines.push_back(fmt::format("{} {} {} ({}{})", loss.what, size, loss.becomes, loss.first, count_text));
    }
    return lines;
}

std::vector<std::string> find_unrepresentable_lengths(const file::Scene& scene, const FloatFormat& format) {
    // A format that has all numbers of binary32 loses none of them.
    const bool is_shared = scene.inputs == file::InputRounding::shared;
    if (is_shared && format.precision >= binary32.precision && format.emin <= binary32.emin &&
        format.emax >= binary32.emax)
        return {};

    const FloatFormat& stored = is_shared ? binary32 : binary64;
    UnrepresentableLengths lost(format);
    const auto round_to_stored = [&](const Real& x) { return toml::round_to_format(x, stored); };
    const Vec<Real>& eye = scene.camera.eye;
    lost.add_point({round_to_stored(eye.x), round_to_stored(eye.y), round_to_stored(eye.z)}, "a coordinate of the eye",
                   [] { return "camera"; });

    // Numbers the primitives of each list from 0, as they are in the file.
    const auto add = [&](const Primitive<double>& primitive, std::string_view what, std::size_t i) {
        lost.add(primitive, [&] { return std::string(what) + "[" + std::to_string(i) + "]"; });
    };
    std::array<std::size_t, shape_rows.size()> count_by_shape{};
    for (const Primitive<Real>& primitive : scene.listed)
        add(round_primitive(primitive, stored), name_of(primitive.shape),
            count_by_shape[static_cast<std::size_t>(primitive.shape)]++);
    std::size_t i = 0;
    if (scene.flake)
        sphere::for_each_primitive(*scene.flake, [&](const Primitive<double>& primitive) {
            add(round_primitive(primitive, stored), "sphereflake", i++);
        });
    i = 0;
    if (scene.mesh)
        for (std::size_t k = 0; k < scene.mesh->faces.size(); ++k)
            add(round_primitive(Primitive<double>(scene.mesh->triangle(k)), stored), "mesh", i++);
    return lost.lines();
}

}  // namespace lostbits::scene::rays
