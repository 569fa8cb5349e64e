// What a program behind a pipe says of itself before anything else, or why it cannot serve.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/doors/contract.hpp"

namespace lostbits::intersect::doors {

struct PipeTerms;

inline constexpr std::string_view pipe_version = "lostbits-pipe/1";

/// The contracts of a header, its lines without the empty one that ends it: after the version, `key=value`, where each
/// `name=` begins a form and what is not said is as in `Contract`. InputError, which begins with `from` and names the
/// line, for unknown keys and words.
std::vector<Contract> read_pipe_header(const std::vector<std::string>& lines, const std::string& from);

/// Sets one of them other than name= by its words; false for an unknown key. InputError, which begins with `where`, for
/// an unknown word.
bool set_word(Contract& contract, const std::string& key, const std::string& value, const std::string& where);

/// The same the other way.
std::string pipe_header_of(const std::vector<Contract>& contracts);

/// Text that a process wrote, for a message: in quotation marks, cut to `most` bytes, what a terminal would obey as
/// \xNN.
std::string shown_text(std::string_view text, std::size_t most = 60);
/// All of it without the quotation marks.
std::string plain_text(std::string_view text);

/// Where the lines of a process come from, and how it is named where they make no sense.
struct Speaker {
    std::function<std::string()> next_line;
    std::function<void(const std::string& what)> fail;  ///< throws
};

/// The contracts of the header, up to the empty line that ends it. InputError for one that makes no sense or says
/// `error=`, EnvironmentError for `missing=`; `fail` where it is no header at all.
std::vector<Contract> read_greeting(const Speaker& speaker, const PipeTerms& terms);

}  // namespace lostbits::intersect::doors
