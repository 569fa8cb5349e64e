// Rays as raw numbers without a header: `--columns` says what they are.
#pragma once

#include "scene/dump/binary_dump.hpp"

namespace lostbits::scene::dump {

class RawDump final : public BinaryDump {
public:
    RawDump(const std::filesystem::path& path, const DumpOptions& options);
};

/// `ox:f32,oy,oz,…`: names and types; a column without a type has that of the one before it. InputError otherwise.
std::vector<BinaryColumn> read_columns(const std::string& text);

}  // namespace lostbits::scene::dump
