#include "fuzz/fuzz.hpp"
#include "intersect/doors/pipe_header.hpp"

namespace lostbits::fuzz {

/// The header of a process behind a pipe: what is read without error is written and read back as the same.
void fuzz_headers(std::string_view bytes) {
    std::vector<std::string> lines;
    for (std::size_t from = 0; from < bytes.size();) {
        const std::size_t end = std::min(bytes.find('\n', from), bytes.size());
        lines.emplace_back(bytes.substr(from, end - from));
        from = end + 1;
    }
    static_cast<void>(intersect::doors::shown_text(bytes));
    answer_or_error([&] {
        const auto contracts = intersect::doors::read_pipe_header(lines, "a pipe");
        const std::string written = intersect::doors::pipe_header_of(contracts);
        std::vector<std::string> again;
        for (std::size_t from = 0; from < written.size();) {
            const std::size_t end = written.find('\n', from);
            again.push_back(written.substr(from, end - from));
            from = end + 1;
        }
        if (!again.empty() && again.back().empty()) again.pop_back();
        if (intersect::doors::read_pipe_header(again, "a pipe") != contracts)
            throw std::logic_error("a header is read back as another one");
    });
}

}  // namespace lostbits::fuzz
