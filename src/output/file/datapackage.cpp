// Writes the `datapackage.json` that describes CSV files.
#include "output/file/csv.hpp"

#include <cctype>

#include "output/file/atomic_file.hpp"
#include "output/file/json.hpp"
#include "output/file/result_folder.hpp"

namespace lostbits::output::file {
namespace {

using Json = OrderedJson;

/// Makes a Frictionless name, which has only lower-case letters, digits, `.`, `_`, `-` and `/`.
std::string slug(std::string_view text) {
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool is_allowed =
            std::isdigit(byte) != 0 || (c >= 'a' && c <= 'z') || c == '.' || c == '_' || c == '-' || c == '/';
        out += is_allowed ? c : (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : '-';
    }
    return out;
}

Json field_json(const Column& column) {
    Json out{{"name", to_valid_utf8(column.name)}, {"type", column.type}};
    if (column.type == "boolean") {
        out["trueValues"] = Json::array({"1"});
        out["falseValues"] = Json::array({"0"});
    }
    if (!column.unit.empty()) out["unit"] = to_valid_utf8(column.unit);
    out["description"] = to_valid_utf8(column.meaning);
    return out;
}

Json resource_json(const DataResource& data) {
    Json fields = Json::array();
    for (const auto& column : data.columns) fields.push_back(field_json(column));
    std::string stem = data.file_name;
    if (stem.ends_with(".csv")) stem.resize(stem.size() - 4);
    return {{"name", slug(stem)},
            {"path", to_valid_utf8(data.file_name)},
            {"title", to_valid_utf8(data.title)},
            {"profile", "tabular-data-resource"},
            {"format", "csv"},
            {"mediatype", "text/csv"},
            {"encoding", "utf-8"},
            {"dialect", {{"delimiter", ","}, {"lineTerminator", "\n"}, {"quoteChar", "\""}, {"doubleQuote", true}}},
            {"schema", {{"fields", fields}, {"missingValues", Json::array({""})}}}};
}

}  // namespace

void write_datapackage(const std::filesystem::path& path, const std::string& title,
                       const std::vector<DataResource>& resources) {
    Json resource_list = Json::array();
    for (const auto& data : resources) resource_list.push_back(resource_json(data));
    Json package{{"profile", "tabular-data-package"}, {"name", slug(title)}, {"title", to_valid_utf8(title)}};
    if (const auto provenance = provenance_of(path)) {
        package["lostbits"] = {{"command", to_valid_utf8(provenance->command)}, {"program", provenance->program}};
        for (const auto& [name, description] : provenance->forms)
            package["lostbits"]["forms"][name] = to_valid_utf8(description);
    }
    package["resources"] = std::move(resource_list);
    write_file(path, json_text(package));
}

}  // namespace lostbits::output::file
