#include <cstring>

#include "analysis/shard/division.hpp"
#include "analysis/shard/pieces.hpp"
#include "fuzz/fuzz.hpp"

namespace lostbits::fuzz {

namespace {

/// The job of the first record, whatever it is: a merge knows it from the command.
std::string first_job(std::string_view file) {
    const std::size_t head = file.find("\n\n");
    std::uint64_t size = 0;
    if (head == std::string_view::npos || file.size() - head < 2 + sizeof size) return "";
    file.remove_prefix(head + 2);
    std::memcpy(&size, file.data(), sizeof size);
    return std::string(file.substr(sizeof size, size));
}

template <class T>
void read_as(output::shard::BitReader& bits) {
    T found{};
    bits(found);
}

/// A record as each command has them.
void read_record(unsigned kind, output::shard::BitReader& bits) {
    using namespace measure;
    switch (kind % 8) {
        case 0: return read_as<std::vector<claim::ClaimResult>>(bits);
        case 1: return read_as<sweep::SweepFindings>(bits);
        case 2: return read_as<std::vector<std::vector<evaluate::FormSummary>>>(bits);
        case 3: return read_as<std::vector<std::optional<sweep::WorstFound>>>(bits);
        case 4: return read_as<sweep::ExhaustiveState>(bits);
        default: break;
    }
    analysis::shard::Noted noted{};
    bits(noted);
    if (noted != analysis::shard::Noted::end) {
        read_as<std::uint64_t>(bits);
        return read_as<output::map::MapPiece>(bits);
    }
    if (kind % 8 == 5) {
        read_as<judge::JudgeResult>(bits);
        read_as<std::vector<judge::WorstRays>>(bits);
    } else if (kind % 8 == 6) {
        read_as<std::vector<evaluate::NeededSummary>>(bits);
    } else {
        read_as<std::vector<evaluate::FormSummary>>(bits);
    }
    read_as<truth::StageCounts>(bits);
}

}  // namespace

/// The file of a shard, as `merge` reads it: its first byte says which command wrote it. The hash at its end is made
/// here, so that what stands in front of it is looked at.
void fuzz_shard(std::string_view bytes) {
    if (bytes.empty()) return;
    const unsigned kind = static_cast<unsigned char>(bytes.front());
    std::string file(bytes.substr(1));
    output::shard::InputHash hash;
    hash.add(file);
    const std::uint64_t sum = hash.value();
    file.append(reinterpret_cast<const char*>(&sum), sizeof sum);
    const std::filesystem::path path = file_of(file);
    answer_or_error([&] {
        const std::string program = output::shard::StateFileReader(path).head().program;
        analysis::shard::Shards shards({path.string()}, program);
        shards.each(first_job(file), [kind](output::shard::BitReader& bits) { read_record(kind, bits); });
        shards.check_end();
    });
}

}  // namespace lostbits::fuzz
