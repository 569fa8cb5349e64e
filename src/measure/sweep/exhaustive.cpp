#include "measure/sweep/exhaustive.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <stdexcept>

#include "intersect/process/parallel.hpp"

namespace lostbits::measure::sweep {

using scene::sweep::FloatRange;

std::uint64_t FloatTally::float_count() const {
    return std::accumulate(outcomes.begin(), outcomes.end(), std::uint64_t{0});
}

std::uint64_t FloatTally::wrong_count() const {
    std::uint64_t sum = 0;
    for (const answer::Outcome outcome : answer::wrong_decisions) sum += count(outcome);
    return sum;
}

void FloatTally::add(std::uint32_t float_index, answer::Outcome outcome, double ulps) {
    const bool is_first = ++outcomes[static_cast<std::size_t>(outcome)] == 1;
    const bool is_worse = std::fabs(ulps) > error_bound;
    if (answer::is_wrong(outcome)) {
        if (!first_wrong) first_wrong = {float_index, outcome};
        last_wrong = {float_index, outcome};
    }
    if (is_worse) {
        worst = {float_index, ulps};
        error_bound = std::fabs(ulps);
    }

    // An event can first happen only at a new outcome or a new worst error.
    if (!is_first && !is_worse) return;
    for (std::size_t e = 0; e < first_events.size(); ++e) {
        const auto& [event, bits] = first_events[e];
        if (!first_floats[e] && (bits > 0 ? error_bound >= std::exp2(bits - 1) : outcome == event))
            first_floats[e] = float_index;
    }
}

void FloatTally::append(const FloatTally& next_part) {
    for (std::size_t o = 0; o < outcomes.size(); ++o) outcomes[o] += next_part.outcomes[o];
    if (next_part.worst && (!worst || std::fabs(next_part.worst->ulps) > std::fabs(worst->ulps)))
        worst = next_part.worst;
    error_bound = std::max(error_bound, next_part.error_bound);
    if (!first_wrong) first_wrong = next_part.first_wrong;
    if (next_part.last_wrong) last_wrong = next_part.last_wrong;
    for (std::size_t e = 0; e < first_floats.size(); ++e) {
        if (!first_floats[e]) first_floats[e] = next_part.first_floats[e];
    }
    if (next_part.padding && (!padding || next_part.padding->u > padding->u)) padding = next_part.padding;
}

namespace {

constexpr std::uint64_t block_size = std::uint64_t{1} << 16;
/// Number of blocks after which the state is complete again: a second of work for ten forms.
constexpr std::size_t blocks_per_state = 32;

/// Part of a binade that one thread tries at a time.
struct Block {
    std::size_t binade;
    FloatRange floats;
};

/// Blocks of a share. A binade is always cut at the same floats, because the cuts may decide which float is found as
/// the worst, within 2^-20 of its error. The 2^32 floats make a little more than 2^16 blocks.
std::vector<Block> cut_into_blocks(const std::vector<BinadePart>& binades, shard::Share share) {
    std::vector<Block> blocks;
    for (std::size_t b = 0; b < binades.size(); ++b) {
        const FloatRange& binade_floats = binades[b].floats;
        for (std::uint64_t begin = 0; begin < binade_floats.size(); begin += block_size)
            blocks.push_back(
                {b,
                 {binade_floats.at(begin), binade_floats.at(std::min(begin + block_size, binade_floats.size()) - 1)}});
    }
    const auto units = share.unit_range(blocks.size());
    const auto block_of_unit = [&blocks](std::uint64_t unit) {
        return blocks.begin() + static_cast<std::ptrdiff_t>(unit);
    };
    return {block_of_unit(units.first), block_of_unit(units.last)};
}

/// Index of the first block that a stopped run has not tried.
std::size_t find_next_block(const std::vector<Block>& blocks, std::uint64_t tried_float_count) {
    std::size_t next_block = 0;
    for (std::uint64_t floats_before = 0; next_block < blocks.size() && floats_before < tried_float_count; ++next_block)
        floats_before += blocks[next_block].floats.size();
    return next_block;
}

/// Tries blocks in parallel, and appends their results to the state in order.
void run_blocks(const ExhaustiveRequest& request, std::span<const Block> blocks, ExhaustiveState& state) {
    const std::size_t ray_count = request.sweep.rays.size(), rows = request.tested_forms.size();
    std::vector<std::vector<FloatTally>> block_tallies(blocks.size() * ray_count);
    std::vector<truth::StageCounts> stages(block_tallies.size());
    intersect::process::in_parallel(std::size_t{0}, block_tallies.size(), [&](std::size_t k) {
        const Block& block = blocks[k / ray_count];
        block_tallies[k] = try_floats({request, k % ray_count, block.floats}, stages[k]);
        request.progress(block.floats.size() * rows);
    });

    for (std::size_t k = 0; k < block_tallies.size(); ++k) {
        const std::size_t tally_index = request.tally_index(blocks[k / ray_count].binade, k % ray_count, 0);
        for (std::size_t form_index = 0; form_index < rows; ++form_index)
            state.tallies[tally_index + form_index].append(block_tallies[k][form_index]);
        state.stages += stages[k];
    }
    for (const Block& block : blocks) state.tried_float_count += block.floats.size();
}

}  // namespace

std::vector<BinadePart> split_into_binades(const scene::sweep::ExhaustiveFile& sweep) {
    std::vector<BinadePart> parts;
    for (std::size_t r = 0; r < sweep.ranges().size(); ++r) {
        const FloatRange& range = sweep.ranges()[r];
        for (std::uint64_t floats_done = 0; floats_done < range.size();) {
            const std::uint32_t first = range.at(floats_done);
            const auto binade = scene::sweep::binade_of(scene::sweep::float_at(first));
            const std::uint32_t last =
                range.falls() ? std::max(binade.low, range.last) : std::min(binade.high, range.last);
            parts.push_back({r, binade, {first, last}});
            floats_done += parts.back().floats.size();
        }
    }
    return parts;
}

std::uint64_t count_floats(const scene::sweep::ExhaustiveFile& sweep, shard::Share share) {
    std::uint64_t sum = 0;
    for (const Block& block : cut_into_blocks(split_into_binades(sweep), share)) sum += block.floats.size();
    return sum;
}

void ExhaustiveState::append(const ExhaustiveState& next_share) {
    tried_float_count += next_share.tried_float_count;
    stages += next_share.stages;
    tallies.resize(std::max(tallies.size(), next_share.tallies.size()));
    for (std::size_t i = 0; i < next_share.tallies.size(); ++i) tallies[i].append(next_share.tallies[i]);
}

void ExhaustiveState::require_match(const ExhaustiveRequest& request) const {
    const std::size_t tallies_per_binade = request.sweep.rays.size() * request.tested_forms.size();
    std::uint64_t counted = 0;
    for (const FloatTally& tally : tallies) counted += tally.float_count();
    if (tallies.size() != split_into_binades(request.sweep).size() * tallies_per_binade ||
        counted != tried_float_count * tallies_per_binade)
        throw std::out_of_range("the tallies belong to another sweep over every float");
}

void run_exhaustive(const ExhaustiveRequest& request, ExhaustiveState& state) {
    const auto binades = split_into_binades(request.sweep);
    const std::vector<Block> all_blocks = cut_into_blocks(binades, request.share);
    state.tallies.resize(binades.size() * request.sweep.rays.size() * request.tested_forms.size());

    for (std::size_t next_block = find_next_block(all_blocks, state.tried_float_count);
         next_block < all_blocks.size();) {
        const std::span blocks =
            std::span(all_blocks).subspan(next_block, std::min(blocks_per_state, all_blocks.size() - next_block));
        run_blocks(request, blocks, state);
        next_block += blocks.size();
        request.store_state(state);
    }
}

std::optional<std::uint32_t> RangeFinding::float_before(std::uint32_t float_index) const {
    const std::uint64_t steps = floats.steps_to(float_index);
    if (steps == 0) return std::nullopt;
    return floats.at(steps - 1);
}

std::vector<RangeFinding> collect_findings(const ExhaustiveRequest& request, const ExhaustiveState& state) {
    const auto binades = split_into_binades(request.sweep);
    std::vector<RangeFinding> findings;
    for (std::size_t form_index = 0; form_index < request.tested_forms.size(); ++form_index) {
        for (std::size_t ray = 0; ray < request.sweep.rays.size(); ++ray) {
            for (std::size_t range = 0; range < request.sweep.ranges().size(); ++range) {
                RangeFinding finding{range, ray, form_index, request.sweep.ranges()[range], {}};
                for (std::size_t b = 0; b < binades.size(); ++b) {
                    if (binades[b].range == range)
                        finding.tally.append(state.tallies[request.tally_index(b, ray, form_index)]);
                }
                findings.push_back(std::move(finding));
            }
        }
    }
    return findings;
}

}  // namespace lostbits::measure::sweep
