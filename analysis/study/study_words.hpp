// Options of studies, which are words: of the command line, of the library, of Python.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lostbits::analysis::study {

/// An option of a study: of its command, and of `lostbits_study`.
struct StudyOption {
    std::string name;  ///< `check`, for --check
    std::string help;
    std::vector<std::string> usual;       ///< its words if it is not given
    std::vector<std::string> known = {};  ///< the words that it can have; empty: the study checks them
};

/// Words of the options of a study, by name.
using StudyWords = std::map<std::string, std::vector<std::string>>;

/// Words of options, each `NAME=WORD`; the usual ones of the options that are not among them. Throws InputError for an
/// unknown name or word.
StudyWords study_words(const std::vector<StudyOption>& options, const std::vector<std::string>& given);

/// The format of studies where none is named.
inline constexpr const char* usual_format = "f32";

}  // namespace lostbits::analysis::study
