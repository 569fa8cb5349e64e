// A change of a form as a patch of the user's own file: the expressions of his function that compute something else are
// written again, in his language and with his names.
#pragma once

#include <memory>
#include <string>

#include "measure/repair/judge.hpp"

namespace lostbits::measure::repair {

struct Patch {
    std::string diff;     ///< unified diff, with the path as the user named the file; empty: see `why_not`
    std::string why_not;  ///< reason for an empty diff, which ends a sentence that names the file first
    std::string file;
};

/// Writes patches of the function behind the request's form.
class Patcher {
public:
    /// `own`: the tape of the form.
    Patcher(const RepairRequest& request, const Tape& own);
    ~Patcher();
    Patcher(const Patcher&) = delete;
    Patcher& operator=(const Patcher&) = delete;

    /// True if the form is a function of a file (`--function`).
    [[nodiscard]] bool has_file() const;
    /// The change that makes the function compute as the tape does. The changed file was compiled and followed, and has
    /// the bits of the tape on the request's rays (at most `few_rays`).
    [[nodiscard]] Patch patch_of(const Tape& now);

private:
    class Writer;
    std::unique_ptr<Writer> writer_;
};

}  // namespace lostbits::measure::repair
