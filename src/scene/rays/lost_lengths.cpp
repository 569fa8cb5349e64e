#include "scene/rays/lost_lengths.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "number/rounded.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::scene::rays {
namespace {

std::string in_words(double x) {
    if (x == 0) return "less than 5e-324";  // an ideal number; none that is 0 by itself is lost
    std::array<char, 32> text{};
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), x, std::chars_format::general, 6).ptr};
}

}  // namespace

void LostLengths::lose(const std::string& what, double value, const char* becomes, const Where& where) {
    const auto same = [&](const Loss& l) { return l.what == what && l.becomes == becomes; };
    const auto found = std::ranges::find_if(losses_, same);
    const std::string place = where();
    if (found == losses_.end()) {
        losses_.push_back({what, becomes, value, place, place, 1});
    } else if (found->last != place) {
        found->last = place;
        ++found->count;
    }
}

void LostLengths::check_point(const double* before, const double* after, const char* what, const Where& where) {
    for (int k = 0; k < 3; ++k) {
        if (!std::isinf(after[k])) continue;
        lose(what, before[k], "rounds to infinity", where);
        return;
    }
}

void LostLengths::add_point(const Vec<double>& before, const char* what, const Where& where) {
    const double from[] = {before.x, before.y, before.z};
    double to[3];
    for (int k = 0; k < 3; ++k) to[k] = rounding::to_format(from[k], 0, format_);
    check_point(from, to, what, where);
}

void LostLengths::add_number(double before, const std::string& what, const Where& where) {
    const double after = rounding::to_format(before, 0, format_);
    if (before != 0 && after == 0) lose(what, before, "rounds to 0", where);
    if (std::isinf(after)) lose(what, before, "rounds to infinity", where);
}

void LostLengths::add(const Solid<double>& before, const Where& where) {
    add(before, round_solid(before, format_), where);
}

void LostLengths::add(const Solid<double>& before, const Solid<double>& after, const Where& where) {
    if (before.shape == Shape::sphere) {
        const double radius = after.numbers[3];
        if (radius == 0) lose("radius", before.numbers[3], "rounds to 0", where);
        if (std::isinf(radius)) lose("radius", before.numbers[3], "rounds to infinity", where);
        check_point(before.numbers.data(), after.numbers.data(), "a coordinate of the centre", where);
        return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const double thickness = before.numbers[k + 3] - before.numbers[k];
        if (!(thickness > 0) || after.numbers[k] != after.numbers[k + 3] || std::isinf(after.numbers[k])) continue;
        lose("thickness", thickness, "rounds to 0", where);
        break;
    }
    check_point(before.numbers.data(), after.numbers.data(), "a coordinate of a corner", where);
    check_point(before.numbers.data() + 3, after.numbers.data() + 3, "a coordinate of a corner", where);
}

std::vector<std::string> LostLengths::lines() const {
    std::vector<std::string> all;
    for (const Loss& l : losses_) {
        all.push_back(l.what + (l.value == 0 ? " " : " = ") + in_words(l.value) + " " + l.becomes + " (" + l.first +
                      (l.count > 1 ? "; " + std::to_string(l.count) + " in all)" : ")"));
    }
    return all;
}

std::vector<std::string> lost_lengths(const file::Scene& scene, const FloatFormat& f) {
    const bool shared = scene.inputs == file::Inputs::shared;
    if (shared && f.precision >= binary32.precision && f.emin <= binary32.emin && f.emax >= binary32.emax) return {};
    const FloatFormat& stored = shared ? binary32 : binary64;
    LostLengths lost(f);
    const auto store = [&](const Real& x) { return toml::round_to_format(x, stored); };
    const Vec<Real>& eye = scene.camera.eye;
    lost.add_point({store(eye.x), store(eye.y), store(eye.z)}, "a coordinate of the eye", [] { return "camera"; });
    const auto add = [&](const Solid<double>& solid, const char* what, std::size_t i) {
        lost.add(solid, [&] { return std::string(what) + "[" + std::to_string(i) + "]"; });
    };
    for (std::size_t i = 0; i < scene.spheres.size(); ++i)
        add(round_solid(Solid<Real>(scene.spheres[i]), stored), "sphere", i);
    for (std::size_t i = 0; i < scene.boxes.size(); ++i)
        add(round_solid(Solid<Real>(scene.boxes[i]), stored), "box", i);
    std::size_t i = 0;
    if (scene.flake)
        file::for_each_sphere(*scene.flake, [&](const Sphere<double>& s) {
            add(round_solid(Solid<double>(s), stored), "sphereflake", i++);
        });
    return lost.lines();
}

}  // namespace lostbits::scene::rays
