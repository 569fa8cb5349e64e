// Reads and writes the manifest of a result folder: the runs that wrote into it, and their files.
#include <algorithm>
#include <fstream>

#include "output/file/csv.hpp"
#include "output/file/json.hpp"
#include "output/file/result_folder.hpp"

namespace lostbits::output::file {

namespace fs = std::filesystem;

namespace {

constexpr const char* schema = "lostbits-manifest/1";

/// True if a name of the manifest stays inside the folder: a manifest may have been edited.
bool is_inside_folder(const std::string& name) {
    const fs::path path(name);
    return !name.empty() && path.is_relative() &&
           std::ranges::none_of(path, [](const fs::path& part) { return part == ".."; });
}

std::string string_member(const nlohmann::json& entry, const char* key) {
    return entry.contains(key) && entry[key].is_string() ? entry[key].get<std::string>() : std::string();
}

ResultFolder::ManifestRun read_run(const nlohmann::json& entry) {
    ResultFolder::ManifestRun run{{string_member(entry, "command"), string_member(entry, "program")}, {}};
    if (entry.contains("forms") && entry["forms"].is_object()) {
        for (const auto& [name, unused] : entry["forms"].items())
            run.provenance.forms.emplace_back(name, string_member(entry["forms"], name.c_str()));
    }
    if (!entry.contains("files")) return run;
    for (const auto& name : entry["files"]) {
        if (name.is_string() && is_inside_folder(name.get<std::string>())) run.files.insert(name.get<std::string>());
    }
    return run;
}

OrderedJson run_json(const Provenance& provenance, const std::set<std::string>& names) {
    auto files = OrderedJson::array();
    for (const std::string& name : names) files.push_back(to_valid_utf8(name));
    OrderedJson json{{"program", provenance.program}, {"command", to_valid_utf8(provenance.command)}};
    for (const auto& [name, description] : provenance.forms) json["forms"][name] = to_valid_utf8(description);
    json["files"] = std::move(files);
    return json;
}

}  // namespace

std::vector<ResultFolder::ManifestRun> manifest_runs(const fs::path& folder) {
    std::ifstream in(folder / manifest_name, std::ios::binary);
    if (!in) return {};
    const auto manifest = nlohmann::json::parse(in, nullptr, false);
    if (!manifest.is_object() || !manifest.contains("schema") || manifest["schema"] != schema ||
        !manifest.contains("files"))
        return {};
    std::vector<ResultFolder::ManifestRun> runs{read_run(manifest)};
    if (!manifest.contains("others") || !manifest["others"].is_array()) return runs;
    for (const auto& entry : manifest["others"]) {
        if (entry.is_object()) runs.push_back(read_run(entry));
    }
    return runs;
}

std::string manifest_text(const ResultFolder::ManifestRun& last_run,
                          const std::vector<ResultFolder::ManifestRun>& others) {
    OrderedJson manifest{{"schema", schema}};
    manifest.update(run_json(last_run.provenance, last_run.files));
    for (const ResultFolder::ManifestRun& other : others)
        manifest["others"].push_back(run_json(other.provenance, other.files));
    return json_text(manifest);
}

}  // namespace lostbits::output::file
