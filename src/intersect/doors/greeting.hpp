// How a process behind a pipe begins: what it says of itself, or why it cannot serve.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "intersect/doors/contract.hpp"
#include "intersect/doors/pipe.hpp"

namespace lostbits::intersect::doors {

/// Where the lines of a process come from, and how it is named where they make no sense.
struct Speaker {
    std::function<std::string()> next_line;
    std::function<void(const std::string& what)> fail;  ///< throws
};

/// The contracts of the header, up to the empty line that ends it. InputError for one that makes no sense or says
/// `error=`, EnvironmentError for `missing=`; `fail` where it is no header at all.
std::vector<Contract> read_greeting(const Speaker& speaker, const PipeTerms& terms);

}  // namespace lostbits::intersect::doors
