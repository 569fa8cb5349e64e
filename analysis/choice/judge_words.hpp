// What the words of `lostbits judge` say of a file of rays.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "intersect/info.hpp"
#include "scene/dump/dump.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::analysis::choice {

struct JudgeWords {
    std::string file, container = "auto", columns, format;
    std::uint64_t skip = 0;
    std::vector<std::string> spheres, boxes;
    std::string scene, miss;
    std::string direction = "any", touching = "hit", at_origin = "hit";
    std::vector<std::string> forms, formats, metrics;
    std::string against;
    std::string size;
    bool rows = false;
    std::size_t worst = 10;
    std::string out;
};

/// The one scene whose solids the rays are aimed at; nothing where none is named. InputError for several, and for one
/// of too many solids.
std::optional<scene::file::Scene> scene_of(const JudgeWords& o, const std::filesystem::path& data);

/// Of the solids that are given once for all rays; nothing where none are.
std::optional<Shape> shape_given(const JudgeWords& o, const std::optional<scene::file::Scene>& scene);

/// These solids, numbers of the format; those of a scene as a map of it has them.
std::vector<Solid<double>> solids_given(const JudgeWords& o, const std::optional<scene::file::Scene>& scene,
                                        const Format& format);

/// The file, opened as the words say.
std::unique_ptr<scene::dump::Dump> open_file(const JudgeWords& o, std::optional<Shape> solid);

/// The contract of the answers.
intersect::Info contract_of(const JudgeWords& o);

}  // namespace lostbits::analysis::choice
