#include "fuzz/fuzz.hpp"
#include "output/claim/claim_history.hpp"

namespace lostbits::fuzz {

/// The file of `check --against`: what is read is written and read back as the same, and is compared with itself.
void fuzz_baseline(std::string_view bytes) {
    using namespace output::claim;
    const std::filesystem::path path = file_of(bytes);
    answer_or_error([&] {
        const ClaimBaseline read = read_baseline(path);
        const ClaimBaseline again = read_baseline(file_of(baseline_text(read)));
        if (again.claims.size() != read.claims.size() || again.command != read.command)
            throw std::logic_error("a baseline is read back as another one");
        for (std::size_t i = 0; i < read.claims.size(); ++i) {
            const ClaimBaseline before{.claims = {read.claims[i]}}, now{.claims = {again.claims[i]}};
            if (moves_between(before, now).same != 1) throw std::logic_error("a claim is read back as another one");
        }
        ClaimBaseline other = read;
        if (!other.claims.empty()) other.claims.back().measured += 1;
        static_cast<void>(moves_text(read, other, moves_between(read, other)));
    });
}

}  // namespace lostbits::fuzz
