// Writes a change of a form as a patch of the user's own file. The patch replaces the expressions of the user's
// function that change. The new expressions are in the language of the file and use its names.
#pragma once

#include <memory>
#include <string>

#include "measure/repair/quality.hpp"

namespace lostbits::measure::repair {

/// Patch of a file, or the reason why it could not be written.
struct Patch {
    std::string diff;    ///< unified diff, with the path that the user gave for the file; empty if the change cannot be
                         ///< written as one
    std::string reason;  ///< if `diff` is empty, why: the end of the sentence "It is not a patch of FILE: …"
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
    [[nodiscard]] bool can_write() const;
    /// Returns a patch with which the function computes what the new tape computes, or the reason why no patch can be
    /// written. The patched file has been compiled, and its operations followed: on at most `few_rays_count` rays of
    /// the request, they give the same bits as the new tape.
    [[nodiscard]] Patch make_patch(const Tape& new_tape);

private:
    class Writer;
    std::unique_ptr<Writer> writer_;
};

}  // namespace lostbits::measure::repair
