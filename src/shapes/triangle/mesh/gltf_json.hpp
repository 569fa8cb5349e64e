// Reads the JSON of a glTF within limits, gives each value its path, and decodes base64 and addresses.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "intersect/process/stop_token.hpp"
#include "number/error.hpp"

namespace lostbits::scene::triangle {

/// Parses the JSON of a file. `json_begin` is the byte of a binary file at which the JSON begins, or 0 for a file of
/// text. Throws InputError, with the position in the file, if the text is not JSON, if its values are nested deeper
/// than those of any mesh, or if it has more values than any mesh. Because of these two limits, no text can exhaust the
/// stack or the memory.
nlohmann::json parse_gltf_json(const std::string& file, std::string_view text, std::uint64_t json_begin,
                               intersect::process::StopToken stop);

/// Decodes base64, in which four letters stand for three bytes. Returns nothing if the text is not base64.
std::optional<std::string> decode_base64(std::string_view letters, intersect::process::StopToken stop);

/// Decodes an address (URI) to the name of a file: `%20` becomes a blank. Returns nothing if the two characters after a
/// `%` are not a hexadecimal number.
std::optional<std::string> decode_uri(std::string_view uri);

/// A value, and its path from the root: `meshes[0].primitives[2]`.
struct GltfValue {
    const nlohmann::json* json_value = nullptr;
    std::string path = {};
    const std::string* file = nullptr;

    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(*file + ": " + (path.empty() ? "" : path + ": ") + problem);
    }
    [[nodiscard]] bool has(const char* key) const { return json_value->contains(key); }
    /// Returns a member of an object; fails if it is missing.
    [[nodiscard]] GltfValue at(const char* key) const {
        if (!json_value->is_object()) fail("is not an object");
        const auto found = json_value->find(key);
        if (found == json_value->end()) fail(std::string("has no ") + key);
        return {&*found, path.empty() ? key : path + '.' + key, file};
    }
    /// Returns the elements of an array; none if the key is missing.
    [[nodiscard]] std::vector<GltfValue> elements(const char* key) const {
        std::vector<GltfValue> values;
        if (!has(key)) return values;
        const GltfValue array = at(key);
        if (!array.json_value->is_array()) array.fail("is not an array");
        for (const nlohmann::json& element : *array.json_value)
            values.push_back({&element, fmt::format("{}[{}]", array.path, values.size()), file});
        return values;
    }
    [[nodiscard]] std::uint64_t unsigned_number() const {
        if (!json_value->is_number_unsigned()) fail("is not a whole number of at least 0");
        return json_value->get<std::uint64_t>();
    }
    [[nodiscard]] std::uint64_t unsigned_number(const char* key, std::uint64_t default_value) const {
        return has(key) ? at(key).unsigned_number() : default_value;
    }
    [[nodiscard]] const std::string& text() const {
        if (!json_value->is_string()) fail("is not a string");
        return json_value->get_ref<const std::string&>();
    }
};

}  // namespace lostbits::scene::triangle
