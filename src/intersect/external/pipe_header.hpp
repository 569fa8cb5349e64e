// The header that a program behind a pipe sends first: its contracts, or why it cannot serve.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/external/contract.hpp"

namespace lostbits::intersect::external {

struct PipeOptions;

inline constexpr std::string_view pipe_version = "lostbits-pipe/1";

/// Reads the contracts from the lines of a header, without the empty line that ends the header. After the version come
/// lines `key=value`; each `name=` begins a form, and a missing key has the default of `Contract`. Throws InputError,
/// which begins with `message_prefix` and names the line, for unknown keys and values.
std::vector<Contract> read_pipe_header(const std::vector<std::string>& lines, const std::string& message_prefix);

/// Sets a property other than `name` from its text. Returns false for an unknown key. Throws InputError, which begins
/// with `message_prefix`, for an unknown value.
bool set_property(Contract& contract, const std::string& key, const std::string& value,
                  const std::string& message_prefix);

/// Writes contracts as a header.
std::string make_pipe_header(const std::vector<Contract>& contracts);

/// Quotes a text that a user or a process wrote, for a message: in quotation marks, cut to `max_bytes` bytes, with
/// control and non-ASCII characters as \xNN.
std::string quote_text(std::string_view text, std::size_t max_bytes = 60);
/// Returns the whole text with control and non-ASCII characters as \xNN, without quotation marks.
std::string escape_text(std::string_view text);

/// A process that sends lines, and a function that throws the error for invalid lines.
struct LineSource {
    std::function<std::string()> next_line;
    std::function<void(const std::string& problem)> fail;  ///< throws
};

/// Reads the contracts of the header, up to the empty line that ends the header. Throws InputError for an invalid
/// header or a header that says `error=`, and EnvironmentError for `missing=`. Calls `fail` if the lines are not a
/// header at all.
std::vector<Contract> read_greeting(const LineSource& source, const PipeOptions& options);

}  // namespace lostbits::intersect::external
