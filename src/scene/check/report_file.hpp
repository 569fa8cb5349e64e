// Reads data/report.toml, which gives the content of a report if the command line names none.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lostbits::scene::check {

struct ReportFile {
    std::vector<std::string> scenes;  ///< ids, with the variant if a scene has several
    std::vector<std::string> sweeps;
    std::vector<std::string> forms;  ///< globs
    std::vector<std::string> formats;
    std::vector<std::string> offsets;  ///< scenes whose next rays are measured
    std::vector<std::string> mends;    ///< SCENE:FORM:BITS: the forms to repair
};

/// Reads the file. Throws InputError with a position for anything that is not such a file.
ReportFile read_report_file(const std::filesystem::path& path);

}  // namespace lostbits::scene::check
