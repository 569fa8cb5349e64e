// A change of a form as a patch of the user's own file: the expressions of the user's function that change are written
// again, in the language and with the names of the file.
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
    /// `old_tape`: the tape of the form.
    Patcher(const RepairRequest& request, const Tape& old_tape);
    ~Patcher();
    Patcher(const Patcher&) = delete;
    Patcher& operator=(const Patcher&) = delete;

    /// True if the form is a function of a file (`--function`).
    [[nodiscard]] bool has_file() const;
    /// Returns the change that makes the function compute as the new tape does. The changed file was compiled and
    /// followed, and gives the bits of the new tape on the request's rays (at most `few_rays`).
    [[nodiscard]] Patch patch_of(const Tape& new_tape);

private:
    class Writer;
    std::unique_ptr<Writer> writer_;
};

}  // namespace lostbits::measure::repair
