// The JSON of a glTF: its values within limits, each with the way to it, and the bytes that its texts stand for.
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

/// The values of a JSON that stands in a file, from byte `begin` on where that is a binary one. InputError with the
/// place for what is no JSON, nests its values deeper than a mesh does or has more of them. Neither the stack nor
/// memory depends on what the text says of itself.
nlohmann::json parse_gltf_json(const std::string& file, std::string_view text, std::uint64_t begin,
                               intersect::process::StopToken stop);

/// The bytes that four letters each of base64 stand for; nothing where they are none.
std::optional<std::string> bytes_of_base64(std::string_view letters, intersect::process::StopToken stop);

/// The name that an address stands for, `%20` being a blank; nothing where it is none.
std::optional<std::string> name_of_uri(std::string_view uri);

/// A value, and the way to it from the top: `meshes[0].primitives[2]`.
struct GltfValue {
    const nlohmann::json* json_value = nullptr;
    std::string way = {};
    const std::string* file = nullptr;

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(*file + ": " + (way.empty() ? "" : way + ": ") + what);
    }
    [[nodiscard]] bool has(const char* key) const { return json_value->contains(key); }
    /// A member that must be there.
    [[nodiscard]] GltfValue at(const char* key) const {
        if (!json_value->is_object()) fail("is not an object");
        const auto found = json_value->find(key);
        if (found == json_value->end()) fail(std::string("has no ") + key);
        return {&*found, way.empty() ? key : way + '.' + key, file};
    }
    /// The elements of an array; none where the key is missing.
    [[nodiscard]] std::vector<GltfValue> elements(const char* key) const {
        std::vector<GltfValue> all;
        if (!has(key)) return all;
        const GltfValue array = at(key);
        if (!array.json_value->is_array()) array.fail("is not an array");
        for (const nlohmann::json& element : *array.json_value)
            all.push_back({&element, fmt::format("{}[{}]", array.way, all.size()), file});
        return all;
    }
    [[nodiscard]] std::uint64_t whole() const {
        if (!json_value->is_number_unsigned()) fail("is not a whole number from 0 on");
        return json_value->get<std::uint64_t>();
    }
    [[nodiscard]] std::uint64_t whole(const char* key, std::uint64_t otherwise) const {
        return has(key) ? at(key).whole() : otherwise;
    }
    [[nodiscard]] const std::string& text() const {
        if (!json_value->is_string()) fail("is not a string");
        return json_value->get_ref<const std::string&>();
    }
};

}  // namespace lostbits::scene::triangle
