#include "analysis/choice/timed.hpp"

#include <fmt/format.h>

#include "number/error.hpp"

namespace lostbits::analysis::choice {

bool is_emulated(const Format& format) { return format.engine == Format::Engine::rounded; }

std::vector<Format> select_timed_formats(const std::vector<std::string>& names) {
    const auto formats = select_formats(names);
    for (const Format& f : formats) {
        if (is_emulated(f))
            throw InputError(fmt::format(
                "-f {}: this format is emulated, so its time says nothing; only f32 and f64 are timed", f.name));
    }
    return formats;
}

scene::file::Scene load_one_scene(const SceneChoice& choice, const std::filesystem::path& data) {
    auto scenes = load_scenes(choice, data);
    if (scenes.size() == 1) return std::move(scenes.front());
    std::string names;
    for (const auto& scene : scenes) names += (names.empty() ? "" : ", ") + scene.id;
    throw InputError(fmt::format("{}: has {} variants, and this is measured of one; name one of {}",
                                 choice.names.front(), scenes.size(), names));
}

std::vector<measure::map::MapRow> timed_on(const scene::file::Scene& scene, const ChosenRows& chosen) {
    return timed_on(scene.id, chosen, [&scene](Shapes forms) { return scene.meets(forms); });
}

std::vector<measure::map::MapRow> timed_on(const std::string& id, const ChosenRows& chosen, const Meets& meets) {
    // A march meets all solids at once, and how long it takes depends on its steps: a time a ray and solid says
    // nothing.
    const Meets can = [&meets](Shapes forms) { return !forms.has(Shape::sdf) && meets(forms); };
    auto timed = rows_meeting(chosen, id, can);
    if (!timed.empty()) return timed;
    throw NothingSelected("none of the selected forms is for the solids of " + id + words_to_meet(chosen.rows, can));
}

}  // namespace lostbits::analysis::choice
