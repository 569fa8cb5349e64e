// Writes a change of a form as a patch of the user's own file. The patch replaces the expressions of the user's
// function that change. The new expressions are in the language of the file and use its names.
#pragma once

#include <memory>
#include <string>

#include "measure/repair/judge.hpp"

namespace lostbits::measure::repair {

struct Patch {
    std::string diff;     ///< unified diff, with the path that the user gave for the file; empty if there is no patch
    std::string why_not;  ///< if `diff` is empty, the reason: the end of the sentence "It is not a patch of FILE: …"
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
    /// Returns a patch with which the function computes what the new tape computes, or the reason why there is none.
    /// `patch_of` has compiled the patched file and followed its operations. On the request's rays (at most `few_rays`
    /// of them), these operations give the same bits as the new tape.
    [[nodiscard]] Patch patch_of(const Tape& new_tape);

private:
    class Writer;
    std::unique_ptr<Writer> writer_;
};

}  // namespace lostbits::measure::repair
