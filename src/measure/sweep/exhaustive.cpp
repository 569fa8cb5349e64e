#include "measure/sweep/exhaustive.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

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

/// The next blocks after so many floats. A binade is always cut at the same places, since what is worst may depend on
/// the cuts within 2^-20 of it.
std::vector<Block> next_blocks(const std::vector<BinadePart>& binades, std::uint64_t tried) {
    std::vector<Block> blocks;
    std::uint64_t before = 0;
    for (std::size_t b = 0; b < binades.size() && blocks.size() < blocks_at_once; ++b) {
        const FloatRange& all = binades[b].floats;
        const std::uint64_t size = all.size();
        for (std::uint64_t begin = tried <= before ? 0 : std::min(size, tried - before);
             begin < size && blocks.size() < blocks_at_once; begin += block_size)
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

void run_exhaustive(const ExhaustiveRequest& request, ExhaustiveState& state) {
    const auto binades = binades_of(*request.sweep);
    const std::size_t rays = request.sweep->rays.size(), rows = request.rows.size();
    const auto truths = rows_by_truth(request.rows, request.limit);
    state.tallies.resize(binades.size() * rays * rows);
    for (;;) {
        const auto blocks = next_blocks(binades, state.tried);
        if (blocks.empty()) return;
        std::vector<std::vector<FloatTally>> found(blocks.size() * rays);
        std::vector<truth::StageCounts> stages(found.size());
        tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t k) {
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
