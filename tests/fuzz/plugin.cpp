#include <array>

#include "fuzz/fuzz.hpp"
#include "intersect/doors/pipe_header.hpp"

namespace lostbits::fuzz {

/// What a library says of a form: a line each for name, title and source, then a byte a number. A form that is taken
/// has a header for pipes, which says the same.
void fuzz_plugin(std::string_view bytes) {
    std::array<std::string, 3> words;
    for (std::string& word : words) {
        const std::size_t end = std::min(bytes.find('\n'), bytes.size());
        word = bytes.substr(0, end);
        bytes.remove_prefix(std::min(end + 1, bytes.size()));
    }
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
        const std::vector<intersect::doors::Contract> told{intersect::doors::contract_of(form, "a library")};
        const std::string header = intersect::doors::pipe_header_of(told);
        std::vector<std::string> lines;
        for (std::size_t from = 0; from + 1 < header.size();) {
            const std::size_t end = header.find('\n', from);
            lines.push_back(header.substr(from, end - from));
            from = end + 1;
        }
        if (intersect::doors::read_pipe_header(lines, "a pipe") != told)
            throw std::logic_error("a contract is another one behind a pipe");
    });
}

}  // namespace lostbits::fuzz
