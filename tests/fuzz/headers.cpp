#include "fuzz/fuzz.hpp"
#include "intersect/doors/pipe.hpp"
#include "intersect/doors/pipe_header.hpp"

namespace lostbits::fuzz {

namespace {

/// The lines of a text one after another; of one that has no more, an end as that of a process.
intersect::doors::Speaker speaker_of(std::string_view text) {
    const auto fail = [](const std::string& what) { throw EnvironmentError("a pipe: " + what); };
    const auto next = [text, fail]() mutable {
        const std::size_t end = text.find('\n');
        if (end == std::string_view::npos) fail("ended without a whole answer");
        std::string line(text.substr(0, end));
        text.remove_prefix(end + 1);
        return line;
    };
    return {next, fail};
}

}  // namespace

/// What a process behind a pipe says first: what is read without error is written and read back as the same.
void fuzz_headers(std::string_view bytes) {
    using intersect::doors::read_greeting;
    const intersect::doors::PipeTerms terms{.who = "a pipe"};
    static_cast<void>(intersect::doors::shown_text(bytes));
    answer_or_error([&] {
        const auto contracts = read_greeting(speaker_of(bytes), terms);
        const std::string written = intersect::doors::pipe_header_of(contracts);
        if (read_greeting(speaker_of(written), terms) != contracts)
            throw std::logic_error("a header is read back as another one");
    });
}

}  // namespace lostbits::fuzz
