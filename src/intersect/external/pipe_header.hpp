// The header that a program behind a pipe sends first: its contracts, or why it cannot serve.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/external/contract.hpp"

namespace lostbits::intersect::external {

struct PipeTerms;

inline constexpr std::string_view pipe_version = "lostbits-pipe/1";

/// Reads the contracts from the lines of a header, without the empty line that ends it. After the version come lines
/// `key=value`; each `name=` begins a form, and a missing key has the default of `Contract`. InputError, which begins
/// with `from` and names the line, for unknown keys and values.
std::vector<Contract> read_pipe_header(const std::vector<std::string>& lines, const std::string& from);

/// Sets a property other than name= from its text; false for an unknown key. InputError, which begins with `where`, for
/// an unknown value.
bool set_word(Contract& contract, const std::string& key, const std::string& value, const std::string& where);

/// Writes contracts as a header.
std::string pipe_header_of(const std::vector<Contract>& contracts);

/// Text that a process wrote, for a message: in quotation marks, cut to `most` bytes, control characters as \xNN.
std::string shown_text(std::string_view text, std::size_t most = 60);
/// The whole text without the quotation marks.
std::string plain_text(std::string_view text);

/// A process that sends lines, and the error to raise if they are invalid.
struct LineSource {
    std::function<std::string()> next_line;
    std::function<void(const std::string& what)> fail;  ///< throws
};

/// Reads the contracts of the header, up to the empty line that ends it. InputError for an invalid one or one that says
/// `error=`, EnvironmentError for `missing=`; calls `fail` if it is not a header at all.
std::vector<Contract> read_greeting(const LineSource& speaker, const PipeTerms& terms);

}  // namespace lostbits::intersect::external
