// An exhaustive sweep: every form on every ray at every float of an axis, binade by binade, in memory that does not
// grow with the axis.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/shard/share.hpp"
#include "measure/sweep/float_tally.hpp"
#include "measure/truth/truth_columns.hpp"
#include "scene/sweep/exhaustive_file.hpp"

namespace lostbits::measure::sweep {

/// A part of an axis with a tally of its own: what a range has of a binade, in the range's order.
struct BinadePart {
    std::size_t range;  ///< of the file's ranges
    scene::sweep::Binade binade;
    scene::sweep::FloatRange floats;
};
std::vector<BinadePart> binades_of(const scene::sweep::ExhaustiveFile& sweep);

struct ExhaustiveRequest;

/// How far a run has come: all that is needed to go on.
struct ExhaustiveState {
    std::uint64_t tried = 0;          ///< of the share's floats, in their order; each by every form on every ray
    std::vector<FloatTally> tallies;  ///< see `ExhaustiveRequest::place`
    truth::StageCounts stages{};      ///< of truths; how many it were depends on how often forms shared them

    /// What the next share found, behind what this one did.
    void append(const ExhaustiveState& after);
    /// Throws std::out_of_range where it cannot be what such a request found.
    void require_of(const ExhaustiveRequest& request) const;
};

struct ExhaustiveRequest {
    const scene::sweep::ExhaustiveFile* sweep = nullptr;
    std::vector<evaluate::TestedForm> rows;  ///< all in binary32
    truth::TruthLimit limit{};
    std::string scene = {};   ///< of a sweep across a mesh: as a command line names it
    shard::Share share = {};  ///< of the blocks into which every binade is cut
    /// Called with so many more floats tried, each counted once a ray and form.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
    /// Called between two parts of the work, when the state is whole.
    std::function<void(const ExhaustiveState&)> keep = [](const ExhaustiveState&) {};

    /// Where the tally of a form on a ray in a binade stands.
    [[nodiscard]] std::size_t place(std::size_t binade, std::size_t ray, std::size_t row) const {
        return (binade * sweep->rays.size() + ray) * rows.size() + row;
    }
};

/// A form on a ray over all floats of a range.
struct RangeFinding {
    std::size_t range, ray, row;
    scene::sweep::FloatRange floats;
    FloatTally tally;  ///< of all of them: as many as were tried, not as many as the ends allow

    /// The float before another in the order of the range; nothing before its first.
    [[nodiscard]] std::optional<std::uint32_t> before(std::uint32_t place) const;
};

/// By row, ray and range.
std::vector<RangeFinding> findings_of(const ExhaustiveRequest& request, const ExhaustiveState& state);

/// How many floats a share has.
std::uint64_t floats_of(const scene::sweep::ExhaustiveFile& sweep, shard::Share share);

/// Goes on until every float of the share is tried. What it finds does not depend on the number of threads, nor on how
/// often it was stopped. When it throws (Interrupted, say), the state is whole: the last that `keep` was called with,
/// or later.
void run_exhaustive(const ExhaustiveRequest& request, ExhaustiveState& state);

}  // namespace lostbits::measure::sweep
