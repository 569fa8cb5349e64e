// Options of studies, and their values on the command line, in the library and in Python.
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
    std::vector<std::string> default_values;       ///< its values if it is not given
    std::vector<std::string> allowed_values = {};  ///< the values that it can have; empty: the study checks them
};

/// Values of the options of a study, by name.
using StudyValues = std::map<std::string, std::vector<std::string>>;

/// Parses options, each `NAME=VALUE`; those that are not given get their usual values. Throws InputError for an unknown
/// name or value.
StudyValues study_values(const std::vector<StudyOption>& options, const std::vector<std::string>& option_texts);

/// The format of studies where none is named.
inline constexpr const char* usual_format = "f32";

}  // namespace lostbits::analysis::study
