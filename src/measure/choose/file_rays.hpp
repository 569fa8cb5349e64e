// Files of rays for a choice: read once, with every ray judged and a sample kept for repeated measurements.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "measure/choose/candidates.hpp"
#include "scene/ray_file/ray_file.hpp"
#include "scene/rays/rays.hpp"
#include "scene/rays/stored_mesh.hpp"

namespace lostbits::measure::choose {

/// Answers that the files bring with them. Their time is not known.
struct FileAnswers {
    std::string name;  ///< `file.NAME`
    Format format;
    FormQuality quality{};
};

struct FileRays {
    std::string result_name;
    std::string typed_file_names;  ///< as the user typed them
    Format format;                 ///< format in which their numbers are stored
    std::uint64_t ray_count = 0;
    std::uint64_t rounded_count = 0;        ///< numbers that the format cannot represent, and that were rounded
    std::vector<FormQuality> quality = {};  ///< one for each of the request's forms, measured on every ray
    std::optional<FileAnswers> answers = {};
    scene::rays::RayGroup sample = {};  ///< every n-th ray, n a power of two: all, or 2049 to 4096 of them
};

/// Properties of the files that their columns do not contain; the command line gives them.
struct FileOptions {
    std::string result_name;
    /// Primitives of all rays. If neither these nor a mesh are given, each ray has its own.
    std::vector<Primitive<double>> primitives = {};
    std::shared_ptr<const scene::rays::StoredMesh> mesh = {};  ///< mesh whose triangles follow `primitives`; or null
    intersect::Info contract{};                                ///< contract of the answers
    /// Receives the number of bytes read since the last call; may throw to stop.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
    [[nodiscard]] std::vector<Primitive<double>> representatives() const {
        return scene::rays::representatives_of(primitives, mesh.get());
    }
};

/// Reads the ray file to its end, for the forms, requirement and limit of the request. Throws InputError as
/// `judge::run_judge` does.
FileRays judge_and_sample(scene::ray_file::RayFile& ray_file, const FileOptions& options, const ChoiceRequest& request);

}  // namespace lostbits::measure::choose
