#include "scene/claim/report_file.hpp"

#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene {

ReportFile read_report_file(const std::filesystem::path& path) {
    const Node root = read_toml(path);
    TableReader file(root);
    require_schema(file, "lostbits-report/1");
    ReportFile report{file.strings("scenes"), file.strings("sweeps"), file.strings("forms"), file.strings("formats")};
    file.reject_unknown_keys();
    return report;
}

}  // namespace lostbits::scene
