// Changes of the measured values of claims between two runs: two commits, compilers or drivers.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "measure/claim/claim.hpp"

namespace lostbits::output::claim {

/// The measurement of a claim in some run.
struct MeasuredClaim {
    std::string id, quantity;
    std::string state;  ///< as in claims.csv
    double measured = 0;
    double low = 0, high = 0;  ///< expected interval
    friend bool operator==(const MeasuredClaim&, const MeasuredClaim&) = default;
};

/// A run of claims, to compare later ones with.
struct ClaimBaseline {
    std::string program = {}, compiler = {}, command = {};
    std::vector<MeasuredClaim> claims = {};
};

/// The run that has just ended. `command` repeats it.
ClaimBaseline baseline_of(const std::vector<scene::claim::Claim>& claims,
                          const std::vector<measure::claim::ClaimResult>& results, const std::string& program,
                          const std::string& command);

/// JSON, `schema` `lostbits-baseline/1`. Every number is also written as a hexadecimal float, which is the one that is
/// read back.
std::string baseline_text(const ClaimBaseline& baseline);
void write_baseline(const std::filesystem::path& path, const ClaimBaseline& baseline);
/// Throws InputError, with the path, if the file is not a baseline.
ClaimBaseline read_baseline(const std::filesystem::path& path);

/// A claim in which two runs differ: in its measured number, to the last bit, in its state, or because one run lacks
/// it.
struct ClaimMove {
    std::optional<MeasuredClaim> before, now;

    [[nodiscard]] const std::string& id() const { return before ? before->id : now->id; }
    /// `13.2 before, 13.25 now (+0.379 %), agrees`.
    [[nodiscard]] std::string words() const;
};

struct ClaimMoves {
    std::vector<ClaimMove> moves;  ///< in the order of the later run, then those that it lacks
    std::size_t same = 0;          ///< claims that both runs have and that measure the same
};
ClaimMoves moves_between(const ClaimBaseline& before, const ClaimBaseline& now);

/// Table of the changes for the terminal, and the two runs.
std::string moves_text(const ClaimBaseline& before, const ClaimBaseline& now, const ClaimMoves& moves);
/// The same as Markdown, for a pull request.
void write_moves(const std::filesystem::path& path, const ClaimBaseline& before, const ClaimBaseline& now,
                 const ClaimMoves& moves);

}  // namespace lostbits::output::claim
