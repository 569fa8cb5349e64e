// Readers under arbitrary bytes. Each target is a function of the bytes, `fuzz_NAME` in NAME.cpp: libFuzzer calls it
// (entry.cpp), and so does the test that replays what was found (test_found.cpp).
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "number/error.hpp"

namespace lostbits::fuzz {

void fuzz_scene(std::string_view bytes);
void fuzz_sweep(std::string_view bytes);
void fuzz_claims(std::string_view bytes);
void fuzz_report(std::string_view bytes);
void fuzz_csv(std::string_view bytes);
void fuzz_rays(std::string_view bytes);
void fuzz_words(std::string_view bytes);
void fuzz_headers(std::string_view bytes);
void fuzz_exr(std::string_view bytes);
void fuzz_baseline(std::string_view bytes);
void fuzz_shard(std::string_view bytes);
void fuzz_ray(std::string_view bytes);
void fuzz_plugin(std::string_view bytes);
void fuzz_requests(std::string_view bytes);
void fuzz_shader(std::string_view bytes);

struct Target {
    std::string_view name;
    void (*run)(std::string_view bytes);
};
inline constexpr Target targets[] = {
    {"scene", fuzz_scene},   {"sweep", fuzz_sweep},       {"claims", fuzz_claims}, {"report", fuzz_report},
    {"csv", fuzz_csv},       {"rays", fuzz_rays},         {"words", fuzz_words},   {"headers", fuzz_headers},
    {"exr", fuzz_exr},       {"baseline", fuzz_baseline}, {"shard", fuzz_shard},   {"ray", fuzz_ray},
    {"plugin", fuzz_plugin}, {"requests", fuzz_requests}, {"shader", fuzz_shader},
};

/// A file in memory that holds the bytes for as long as nobody asks for the next one.
std::filesystem::path file_of(std::string_view bytes);

/// Bad input ends in an answer or in an error that says something, with the exit code of bad input. Anything else,
/// std::bad_alloc and Exit::internal among it, is left to whoever calls.
template <class Ask>
void answer_or_error(const Ask& ask) {
    try {
        ask();
    } catch (const Error& error) {
        if (error.code() == Exit::internal || std::string_view(error.what()).empty())
            throw std::logic_error("an error that no input should cause: " + std::string(error.what()));
    }
}

}  // namespace lostbits::fuzz
