// What a command is about that takes a scene or files of rays.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "analysis/choice/judge_words.hpp"
#include "measure/choice/file_rays.hpp"

namespace lostbits::analysis::choice {

/// Files of rays are told by their ending, or by a word that only they take.
bool are_files(const RayFileWords& words, const std::vector<std::string>& subjects);

/// InputError for an option of files beside a scene, for one of scenes, each with whether it was given, beside files,
/// and for several scenes. `command` is what they are for: `a choice`.
void refuse_others(const RayFileWords& words, const std::vector<std::string>& subjects,
                   const std::vector<std::pair<const char*, bool>>& of_scenes, const char* command);

/// Files of rays as one, ready to be read.
struct OpenedRays {
    std::string id, words;  ///< what results are called, and the files in words of a shell
    std::unique_ptr<scene::dump::Dump> dump;
    measure::choice::FileTerms terms;
    Shapes shapes;  ///< of what the rays are aimed at
};
OpenedRays open_rays(const RayFileWords& words, const std::vector<std::string>& files,
                     const std::filesystem::path& data);

/// Says on stderr that numbers of the files were rounded.
void note_rounded(const measure::choice::FileRays& rays, bool quiet);

}  // namespace lostbits::analysis::choice
