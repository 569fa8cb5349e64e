// On how many hits form and truth agree, and whether those are enough for a quantile over them to stand for the form.
#pragma once

#include <cstdint>
#include <string>

#include "measure/truth/missing.hpp"

namespace lostbits::measure::metric {

/// A form that misses nearly everything may be exact on the few hits that are left to it. Below this share of the rays
/// that truly hit, pictures, plots, tables on the terminal and the page withhold quantiles over agreed hits, and say
/// so. CSV files have them all the same, beside the counts.
inline constexpr double least_agreement = 0.1;

struct Agreement {
    std::uint64_t agreed;     ///< rays whose error is measured: form and truth agree on the hit
    std::uint64_t true_hits;  ///< rays that truly hit

    /// NaN where no ray truly hits.
    [[nodiscard]] double share() const { return truth::fraction(agreed, true_hits); }
    /// Whether a quantile over the agreed hits may stand for the form.
    [[nodiscard]] bool is_enough() const {
        return agreed > 0 && static_cast<double>(agreed) >= least_agreement * static_cast<double>(true_hits);
    }
    /// `of 55 agreed hits`: stands beside a quantile.
    [[nodiscard]] std::string of_agreed_hits() const { return "of " + counted(agreed, "agreed hit"); }
    /// `55 of 16384 hits agree`: stands in place of a withheld one.
    [[nodiscard]] std::string too_few() const {
        return std::to_string(agreed) + " of " + counted(true_hits, "hit") + (agreed == 1 ? " agrees" : " agree");
    }

private:
    static std::string counted(std::uint64_t n, const char* what) {
        return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
    }
};

}  // namespace lostbits::measure::metric
