#include "scene/check/report_file.hpp"

#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::check {

ReportFile read_report_file(const std::filesystem::path& path) {
    const toml::Node root = toml::read_toml(path);
    toml::TableReader file(root);
    toml::require_schema(file, "lostbits-report/1");
    ReportFile report{file.strings("scenes"),
                      file.strings("sweeps"),
                      file.strings("forms"),
                      file.strings("formats"),
                      file.optional_strings("offsets").value_or(std::vector<std::string>{}),
                      file.optional_strings("mends").value_or(std::vector<std::string>{})};
    file.require_known_keys();
    return report;
}

}  // namespace lostbits::scene::check
