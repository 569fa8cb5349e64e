// Readers under arbitrary bytes. Each target is a function of the bytes, `fuzz_NAME`, and a row of `targets`: libFuzzer
// calls it (entry.cpp), and so does the test that replays what was found (test_found.cpp).
#pragma once

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "number/error.hpp"

namespace lostbits::fuzz {

using Fuzz = void(std::string_view bytes);
Fuzz fuzz_scene, fuzz_sweep, fuzz_claims, fuzz_report, fuzz_csv, fuzz_rays, fuzz_words, fuzz_ray;
Fuzz fuzz_headers, fuzz_plugin, fuzz_requests, fuzz_shader, fuzz_shard, fuzz_exr, fuzz_mesh;
Fuzz fuzz_llvm, fuzz_spirv;

struct Target {
    std::string_view name;
    Fuzz* run;
};
inline constexpr Target targets[] = {
    {"scene", fuzz_scene},       {"sweep", fuzz_sweep},   {"claims", fuzz_claims}, {"report", fuzz_report},
    {"csv", fuzz_csv},           {"rays", fuzz_rays},     {"words", fuzz_words},   {"headers", fuzz_headers},
    {"exr", fuzz_exr},           {"shard", fuzz_shard},   {"ray", fuzz_ray},       {"plugin", fuzz_plugin},
    {"requests", fuzz_requests}, {"shader", fuzz_shader}, {"mesh", fuzz_mesh},     {"llvm", fuzz_llvm},
    {"spirv", fuzz_spirv},
};

/// A file in memory that holds the bytes until the next one is requested; its path ends in `extension`.
std::filesystem::path file_of(std::string_view bytes, std::string_view extension = "");

/// Removes the first line with its line break and returns it.
inline std::string take_line(std::string_view& bytes) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string line(bytes.substr(0, end));
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    return line;
}

/// Bad input must end in an answer, or in an error with a message and the exit status of bad input. Anything else,
/// including std::bad_alloc and ExitStatus::internal, is left to the caller.
template <class Ask>
void answer_or_error(const Ask& ask) {
    try {
        ask();
    } catch (const Error& error) {
        if (error.status() == ExitStatus::internal || std::string_view(error.what()).empty())
            throw std::logic_error("an error that no input should cause: " + std::string(error.what()));
    }
}

}  // namespace lostbits::fuzz
