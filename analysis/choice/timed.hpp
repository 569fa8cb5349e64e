// What can be timed: forms in formats that a processor has, on the rays of one scene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/choice/select.hpp"

namespace lostbits::analysis::choice {

/// Whether a format is computed by software here, so that its time says nothing.
[[nodiscard]] bool is_emulated(const Format& format);

/// f32 and f64, by name. InputError for any other format: it is emulated.
std::vector<Format> select_timed_formats(const std::vector<std::string>& names);

/// The one scene that is named. InputError where its file has several variants and none is named.
scene::file::Scene load_one_scene(const SceneChoice& choice, const std::filesystem::path& data);

/// Those of the rows whose time on the scene means something: its solids' forms, or sets of them (`rows_meeting`), but
/// no marches. NothingSelected where that leaves none.
std::vector<measure::map::MapRow> timed_on(const scene::file::Scene& scene, const ChosenRows& chosen);
/// The same of anything with solids, which is called `id`.
std::vector<measure::map::MapRow> timed_on(const std::string& id, const ChosenRows& chosen, const Meets& meets);

}  // namespace lostbits::analysis::choice
