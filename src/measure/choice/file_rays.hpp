// Files of rays as a choice takes them: read once, every ray judged, some kept for what is measured again and again.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "measure/choice/candidates.hpp"
#include "scene/dump/dump.hpp"
#include "scene/rays/rays.hpp"
#include "scene/rays/stored_mesh.hpp"

namespace lostbits::measure::choice {

/// The answers that the files have of their own. Their time is not known.
struct FileAnswers {
    std::string name;  ///< `file.NAME`
    Format format;
    Worth worth{};
};

struct FileRays {
    std::string id;    ///< what results are called
    std::string name;  ///< of the files, as they were typed
    Format format;     ///< that their numbers are stored in
    std::uint64_t rays = 0;
    std::uint64_t rounded = 0;      ///< numbers that the format does not hold
    std::vector<Worth> worth = {};  ///< of the request's rows, over every ray
    std::optional<FileAnswers> answers = {};
    scene::rays::RayGroup sample = {};  ///< every n-th ray, n a power of two: all, or 2049 to 4096 of them
};

/// What the command line says of the files, beside their columns.
struct FileTerms {
    std::string id;  ///< what results are called
    /// Of all rays; each has its own where there are none, and no mesh.
    std::vector<Solid<double>> solids = {};
    std::shared_ptr<const scene::rays::MeshColumns> mesh = {};  ///< whose triangles come after these; null: none
    intersect::Info contract{};                                 ///< of the answers
    /// With the bytes of the files that are done since the last call; may throw to stop.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
    [[nodiscard]] std::vector<Solid<double>> examples() const { return scene::rays::examples_of(solids, mesh.get()); }
};

/// Reads the dump to its end, for the rows, wish and limit of the request. InputError as `judge::run_judge`.
FileRays judge_rays(scene::dump::Dump& dump, const FileTerms& terms, const ChoiceRequest& request);

}  // namespace lostbits::measure::choice
