#include "measure/sweep/exhaustive.hpp"

#include <algorithm>
#include <stdexcept>

#include "intersect/process/parallel.hpp"
#include "measure/sweep/exhaustive_block.hpp"

namespace lostbits::measure::sweep {

using scene::sweep::FloatRange;

namespace {

constexpr std::uint64_t block_size = std::uint64_t{1} << 16;
constexpr std::size_t blocks_at_once = 32;  // the state is whole after each so many: a second's work for ten forms

/// A part of a binade that one thread tries.
struct Block {
    std::size_t binade;
    FloatRange floats;
};

/// The first and the last float of a share, as places in the axis; `last` is behind it. A binade is always cut at the
/// same places, since what is worst may depend on the cuts within 2^-20 of it.
struct Stretch {
    std::uint64_t first = 0, last = 0;
};

Stretch stretch_of(const std::vector<BinadePart>& binades, shard::Share share) {
    std::uint64_t blocks = 0;
    for (const BinadePart& part : binades) blocks += (part.floats.size() + block_size - 1) / block_size;
    const auto units = share.of_units(blocks);
    const auto place = [&](std::uint64_t block) {
        std::uint64_t before = 0;
        for (const BinadePart& part : binades) {
            const std::uint64_t size = part.floats.size(), here = (size + block_size - 1) / block_size;
            if (block < here) return before + block * block_size;
            block -= here;
            before += size;
        }
        return before;
    };
    return {place(units.first), place(units.last)};
}

/// The next blocks of a stretch.
std::vector<Block> next_blocks(const std::vector<BinadePart>& binades, const Stretch& left) {
    std::vector<Block> blocks;
    std::uint64_t before = 0;
    for (std::size_t b = 0; b < binades.size() && blocks.size() < blocks_at_once; ++b) {
        const FloatRange& all = binades[b].floats;
        const std::uint64_t size = all.size(), end = left.last <= before ? 0 : std::min(size, left.last - before);
        for (std::uint64_t begin = left.first <= before ? 0 : std::min(size, left.first - before);
             begin < end && blocks.size() < blocks_at_once; begin += block_size)
            blocks.push_back({b, {all.at(begin), all.at(std::min(begin + block_size, size) - 1)}});
        before += size;
    }
    return blocks;
}

}  // namespace

std::vector<BinadePart> binades_of(const scene::sweep::ExhaustiveFile& sweep) {
    std::vector<BinadePart> parts;
    for (std::size_t r = 0; r < sweep.ranges().size(); ++r) {
        const FloatRange& range = sweep.ranges()[r];
        for (std::uint64_t done = 0; done < range.size();) {
            const std::uint32_t first = range.at(done);
            const auto binade = scene::sweep::binade_of(scene::sweep::float_at(first));
            const std::uint32_t last =
                range.falls() ? std::max(binade.low, range.last) : std::min(binade.high, range.last);
            parts.push_back({r, binade, {first, last}});
            done += parts.back().floats.size();
        }
    }
    return parts;
}

std::uint64_t floats_of(const scene::sweep::ExhaustiveFile& sweep, shard::Share share) {
    const Stretch all = stretch_of(binades_of(sweep), share);
    return all.last - all.first;
}

void ExhaustiveState::append(const ExhaustiveState& after) {
    tried += after.tried;
    stages += after.stages;
    tallies.resize(std::max(tallies.size(), after.tallies.size()));
    for (std::size_t i = 0; i < after.tallies.size(); ++i) tallies[i].append(after.tallies[i]);
}

void ExhaustiveState::require_of(const ExhaustiveRequest& request) const {
    const std::size_t each = request.sweep->rays.size() * request.rows.size();
    std::uint64_t counted = 0;
    for (const FloatTally& tally : tallies) counted += tally.floats();
    if (tallies.size() != binades_of(*request.sweep).size() * each || counted != tried * each)
        throw std::out_of_range("tallies of a sweep over every float are those of another");
}

void run_exhaustive(const ExhaustiveRequest& request, ExhaustiveState& state) {
    const auto binades = binades_of(*request.sweep);
    const std::size_t rays = request.sweep->rays.size(), rows = request.rows.size();
    const auto truths = rows_by_truth(request.rows, request.limit);
    const Stretch all = stretch_of(binades, request.share);
    state.tallies.resize(binades.size() * rays * rows);
    for (;;) {
        const auto blocks = next_blocks(binades, {all.first + state.tried, all.last});
        if (blocks.empty()) return;
        std::vector<std::vector<FloatTally>> found(blocks.size() * rays);
        std::vector<truth::StageCounts> stages(found.size());
        intersect::process::in_parallel(std::size_t{0}, found.size(), [&](std::size_t k) {
            const Block& block = blocks[k / rays];
            found[k] = try_floats({*request.sweep, request.rows, truths, k % rays, block.floats}, stages[k]);
            request.progress(block.floats.size() * rows);
        });
        for (std::size_t k = 0; k < found.size(); ++k) {
            const std::size_t place = request.place(blocks[k / rays].binade, k % rays, 0);
            for (std::size_t row = 0; row < rows; ++row) state.tallies[place + row].append(found[k][row]);
            state.stages += stages[k];
        }
        for (const Block& block : blocks) state.tried += block.floats.size();
        request.keep(state);
    }
}

}  // namespace lostbits::measure::sweep
