// The loops of a GLSL file, as far as its tokens bound them.
#pragma once

#include <cstddef>
#include <vector>

#include "intersect/shader/tokens.hpp"

namespace lostbits::intersect::shader {

/// A loop that the file bounds by a whole number, or not at all.
struct CountedLoop {
    static constexpr long long endless = 1'000'000'000'001;  ///< more than any that is bounded

    std::size_t line;
    long long most;      ///< times it runs
    long long together;  ///< the same times those of the loops that it stands in
};

/// The loops that begin at, or are compared with, a whole number, and those without an end. `all` are the tokens of the
/// file, `code` what `code_tokens` gives.
std::vector<CountedLoop> loops_of(const std::vector<Token>& all, const std::vector<Token>& code);

}  // namespace lostbits::intersect::shader
