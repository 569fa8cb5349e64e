#include "analysis/choice/doors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <thread>

#include "intersect/doors/formulas.hpp"
#include "intersect/doors/guard.hpp"
#include "intersect/doors/pipe.hpp"
#include "intersect/doors/plugin.hpp"
#include "number/error.hpp"
#include "output/blame/explain_command.hpp"
#include "output/file/atomic_file.hpp"

namespace lostbits::analysis::choice {

using intersect::doors::ForeignForm;
using output::blame::shell_word;

namespace {

/// The forms of a library, from a process of this program that holds it.
std::vector<ForeignForm> isolated(const std::filesystem::path& library, intersect::doors::PipeTerms terms) {
    std::error_code unknown;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
    if (unknown)
        throw EnvironmentError("--isolate: this system does not say where the program lies (/proc is missing)");
    terms.who = library.string() + " in a process of its own";
    return intersect::doors::open_pipe(
        fmt::format("exec {} plugin serve {}", shell_word(program.string()), shell_word(library.string())), terms);
}

}  // namespace

Behind open_each(const DoorWords& words, int threads) {
    if (words.isolate && words.plugins.empty()) throw InputError("--isolate: is for libraries; name one by --plugin");
    if (words.plugins.empty() && words.pipes.empty()) return {};
    intersect::doors::guard_foreign_code({words.seconds, output::file::remove_partial_files});
    const int processes = threads > 0 ? threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const intersect::doors::PipeTerms terms{.seconds = words.seconds, .processes = static_cast<unsigned>(processes)};
    Behind found;
    const auto add = [](auto more, auto& all) { std::ranges::move(more, std::back_inserter(all)); };
    std::string again;
    for (const std::string& named : words.plugins) {
        const auto library = intersect::doors::find_plugin(named);
        add(words.isolate ? isolated(library, terms) : intersect::doors::load_plugin(library), found.forms);
        if (!words.isolate) add(intersect::doors::load_formulas(library), found.formulas);
        again += " --plugin " + shell_word(named);
    }
    for (const std::string& command : words.pipes) {
        add(intersect::doors::open_pipe(command, terms), found.forms);
        again += " --pipe " + shell_word(command);
    }
    output::blame::say_where_forms_are_from(again);
    return found;
}

void open_doors(const DoorWords& words, int threads) {
    Behind found = open_each(words, threads);
    // A library with formulas answers through the C interface too: for --isolate and `plugin check`.
    std::erase_if(found.forms, [&found](const ForeignForm& form) {
        return std::ranges::any_of(found.formulas,
                                   [&form](const auto& f) { return f.row.info->name == form.contract.name; });
    });
    intersect::doors::enroll_formulas(found.formulas);
    intersect::doors::enroll(std::move(found.forms));
}

}  // namespace lostbits::analysis::choice
