#include "intersect/doors/greeting.hpp"

#include <string_view>

#include "intersect/doors/pipe_header.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::doors {
namespace {

/// Ends the run where the header says why the program cannot serve.
void refuse_for(const std::vector<std::string>& lines, const PipeTerms& terms) {
    std::string words;
    bool machine = false;
    for (const std::string_view line : lines) {
        const bool missing = line.starts_with("missing=");
        if (!missing && !line.starts_with("error=")) continue;
        machine = machine || missing;
        const std::string_view said = line.substr(line.find('=') + 1);
        words += (words.empty() ? "" : "\n") + (terms.ours ? std::string(said) : plain_text(said));
    }
    if (words.empty()) return;
    if (!terms.ours) words = terms.who + ": refuses: " + words;
    if (machine) throw EnvironmentError(words);
    throw InputError(words);
}

}  // namespace

std::vector<Contract> read_greeting(const Speaker& speaker, const PipeTerms& terms) {
    std::vector<std::string> lines;
    for (std::size_t bytes = 0;;) {
        lines.push_back(speaker.next_line());
        if (lines.size() == 1 && lines.front() != pipe_version)
            speaker.fail("says " + shown_text(lines.front()) +
                         " first; the first line of its standard output must be " + std::string(pipe_version) +
                         " and all else it prints go to standard error");
        if (lines.back().empty()) break;
        bytes += lines.back().size();
        if (bytes > 100'000) speaker.fail("has a header without end; an empty line ends it");
    }
    lines.pop_back();
    refuse_for(lines, terms);
    return read_pipe_header(lines, terms.who);
}

}  // namespace lostbits::intersect::doors
