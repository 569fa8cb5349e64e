// Input from other processes: libraries, pipes, shaders, shards.
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstring>

#include "analysis/shard/division.hpp"
#include "analysis/shard/pieces.hpp"
#include "fuzz/fuzz.hpp"
#include "intersect/external/pipe.hpp"
#include "intersect/external/pipe_header.hpp"
#include "intersect/shader/compiler_log.hpp"
#include "intersect/shader/kernel.hpp"
#include "measure/consistency/consistency.hpp"
#include "measure/offset/offsets.hpp"
#include "measure/render/render.hpp"

namespace lostbits::fuzz {
namespace {

/// The lines of a text one after another; after the last line, the end of a process.
intersect::external::LineSource speaker_of(std::string_view text) {
    const auto fail = [](const std::string& what) { throw EnvironmentError("a pipe: " + what); };
    const auto next = [text, fail]() mutable {
        if (text.find('\n') == std::string_view::npos) fail("ended before it had written a whole answer");
        return take_line(text);
    };
    return {next, fail};
}

/// The job of the first record, whatever it is: a merge knows the job from the command.
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
    switch (kind % 11) {
        case 0: return read_as<std::vector<check::ClaimResult>>(bits);
        case 1: return read_as<sweep::SweepFindings>(bits);
        case 2: return read_as<std::vector<std::vector<evaluate::FormSummary>>>(bits);
        case 3: return read_as<std::vector<std::optional<sweep::WorstResult>>>(bits);
        case 4: return read_as<sweep::ExhaustiveState>(bits);
        default: break;
    }
    analysis::shard::RecordKind noted{};
    bits(noted);
    if (noted != analysis::shard::RecordKind::end) {
        read_as<std::uint64_t>(bits);
        return read_as<output::pixel::Piece>(bits);
    }
    if (kind % 11 == 8) return read_as<std::vector<consistency::FormChecks>>(bits);
    if (kind % 11 == 9) return read_as<std::vector<offset::OffsetSummary>>(bits);
    if (kind % 11 == 10) return read_as<std::vector<render::RenderStudy::Summary>>(bits);
    if (kind % 11 == 5) {
        read_as<judge::JudgeResult>(bits);
        read_as<std::vector<judge::WorstRays>>(bits);
    } else if (kind % 11 == 6) {
        read_as<std::vector<evaluate::BitsNeededSummary>>(bits);
    } else {
        read_as<std::vector<evaluate::FormSummary>>(bits);
    }
    read_as<truth::StageCounts>(bits);
}

}  // namespace

/// First lines of a process behind a pipe. If they are read without error, they are written and read back as the same.
void fuzz_headers(std::string_view bytes) {
    using intersect::external::read_greeting;
    const intersect::external::PipeOptions options{.message_prefix = "a pipe"};
    static_cast<void>(intersect::external::quote_text(bytes));
    answer_or_error([&] {
        const auto contracts = read_greeting(speaker_of(bytes), options);
        const std::string written = intersect::external::make_pipe_header(contracts);
        if (read_greeting(speaker_of(written), options) != contracts)
            throw std::logic_error("a header is read back as another one");
    });
}

/// Description of a form by a library: a line each for name, title and source, then one byte per number. A form that is
/// accepted has a header for pipes with the same content.
void fuzz_plugin(std::string_view bytes) {
    std::array<std::string, 3> words;
    for (std::string& word : words) word = take_line(bytes);
    std::array<int, 7> numbers{};
    for (std::size_t i = 0; i < std::min(numbers.size(), bytes.size()); ++i)
        numbers[i] = static_cast<signed char>(bytes[i]);
    lb_form form{};
    form.name = words[0].empty() ? nullptr : words[0].c_str();
    form.title = words[1].empty() ? nullptr : words[1].c_str();
    form.source = words[2].empty() ? nullptr : words[2].c_str();
    form.shape = numbers[0];
    form.format = numbers[1];
    form.direction = numbers[2];
    form.roots = numbers[3];
    form.touching = numbers[4];
    form.at_origin = numbers[5];
    form.flags = static_cast<unsigned>(numbers[6]);
    form.run = bytes.size() > numbers.size() ? nullptr : +[](const lb_batch*) -> const char* { return nullptr; };
    answer_or_error([&] {
        const std::vector<intersect::external::Contract> contracts{
            intersect::external::read_form_contract(form, "a library")};
        const std::string header = intersect::external::make_pipe_header(contracts);
        std::vector<std::string> lines;
        for (std::string_view rest = header; rest.size() > 1;) lines.push_back(take_line(rest));
        if (intersect::external::read_pipe_header(lines, "a pipe") != contracts)
            throw std::logic_error("a contract is another one behind a pipe");
    });
}

/// Requests to `plugin serve` through a pipe: batches for two forms, one of which refuses.
void fuzz_requests(std::string_view bytes) {
    using intersect::external::ForeignForm;
    static const std::vector<ForeignForm> forms = [] {
        std::vector<ForeignForm> two(2);
        two[0].answer = [](const lb_batch& batch) {
            for (std::size_t i = 0; i < batch.size; ++i) {
                static_cast<float*>(batch.near_far)[2 * i] = static_cast<const float*>(batch.rays)[6 * i + 5];
                batch.hit[i] = 1;
            }
        };
        two[1].contract.shape = Shape::box;
        two[1].contract.bits = 64;
        two[1].answer = [](const lb_batch& batch) {
            if (batch.ends == nullptr) throw EnvironmentError("a box: refuses");
            for (std::size_t i = 0; i < batch.size; ++i)
                static_cast<double*>(batch.near_far)[2 * i] = static_cast<const double*>(batch.rays)[6 * i + 5];
        };
        return two;
    }();
    const std::filesystem::path path = file_of(bytes);
    const int input = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    static const int output = open("/dev/null", O_WRONLY | O_CLOEXEC);
    static_cast<void>(intersect::external::serve_pipe(forms, input, output));
    close(input);
}

/// A file of GLSL: its first line is the text behind the colon of `--shader`. If the file is accepted, its programs are
/// written, and its own lines are read as the log of a compiler.
void fuzz_shader(std::string_view bytes) {
    using namespace intersect::shader;
    std::string words = take_line(bytes);
    std::erase(words, '\0');  // no word of a command line contains one
    const std::filesystem::path path = file_of(bytes);
    answer_or_error([&] {
        const ShaderSource shader = read_shader(path.string() + ":" + words);
        for (const int bits : {32, 64}) static_cast<void>(write_program_text(shader, bits, 450));
        static_cast<void>(errors_of(shader.text, shader));
    });
}

/// The file of a shard, as `merge` reads it: its first byte selects the command that wrote it. The hash at its end is
/// computed here, so that the bytes before it are read.
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
        shards.for_each_record(first_job(file), [kind](output::shard::BitReader& bits) { read_record(kind, bits); });
        shards.require_end();
    });
}

}  // namespace lostbits::fuzz
