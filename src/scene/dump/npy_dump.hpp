// Rays as an array of numpy, plain or of records with named fields.
#pragma once

#include <string_view>

#include "scene/dump/binary_dump.hpp"

namespace lostbits::scene::dump {

/// Versions 1 to 3. The last axis of a plain array is the columns, which `--columns` names; the axes before it, or all
/// axes of an array of records, are rays, and two of them are a picture of so many rows and columns.
class NpyDump final : public BinaryDump {
public:
    NpyDump(const std::filesystem::path& path, const DumpOptions& options);
    [[nodiscard]] std::optional<std::pair<int, int>> picture() const override { return picture_; }

private:
    std::optional<std::pair<int, int>> picture_;
};

/// The dictionary in front of an array.
struct NpyHeader {
    struct Field {
        std::string name;  ///< empty where the array has no fields
        std::string type;
        std::vector<std::uint64_t> shape = {};  ///< of a field that is an array itself
    };
    std::vector<Field> fields;
    bool fortran = false;
    std::vector<std::uint64_t> shape;
    bool structured = false;
};

/// InputError that begins with `where` for anything else.
NpyHeader read_npy_header(std::string_view text, const std::string& where);

}  // namespace lostbits::scene::dump
