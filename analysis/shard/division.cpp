#include "analysis/shard/division.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "number/error.hpp"
#include "scene/toml/files_of_run.hpp"

namespace lostbits::analysis::shard {

namespace fs = std::filesystem;

using measure::shard::Share;
using output::shard::StateFileReader;
using output::shard::StateHead;

namespace {

std::optional<std::uint64_t> whole_number(std::string_view text) {
    std::uint64_t n = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), n);
    if (text.empty() || error != std::errc{} || stop != text.data() + text.size()) return std::nullopt;
    return n;
}

/// The state files of shards in a folder or in its subfolders; or the named file itself.
std::vector<fs::path> state_files(const fs::path& named) {
    std::error_code ignored;
    if (fs::is_regular_file(named, ignored)) return {named};
    if (fs::is_regular_file(named / output::shard::state_file_name, ignored))
        return {named / output::shard::state_file_name};
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(named, ignored)) {
        const fs::path file = entry.path() / output::shard::state_file_name;
        if (fs::is_regular_file(file, ignored)) found.push_back(file);
    }
    if (!fs::exists(named, ignored))
        throw InputError(named.string() +
                         ": does not exist; name the folder given by -o to the runs with --shard, or the shard-K-of-N "
                         "folders in it");
    if (found.empty())
        throw InputError(named.string() +
                         ": has no shard; name the folder given by -o to the runs with --shard, or the shard-K-of-N "
                         "folders in it");
    std::ranges::sort(found);
    return found;
}

std::string shard_text(Share share) { return fmt::format("{}/{}", share.number, share.count); }

/// `2, 5 to 7 and 9`.
std::string ranges_text(const std::vector<std::uint64_t>& numbers) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t end = i + 1;
        while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
        parts.push_back(end - i > 2 ? fmt::format("{} to {}", numbers[i], numbers[end - 1])
                                    : std::to_string(numbers[i]));
        i = end - i > 2 ? end : i + 1;
    }
    if (parts.size() == 1) return parts.front();
    const std::string last = parts.back();
    parts.pop_back();
    return fmt::format("{} and {}", fmt::join(parts, ", "), last);
}

}  // namespace

Share share_named(const std::string& word) {
    const std::size_t slash = word.find('/');
    const auto number = whole_number(std::string_view(word).substr(0, slash));
    const auto of = slash == std::string::npos ? std::nullopt : whole_number(std::string_view(word).substr(slash + 1));
    if (!number || !of) throw InputError(fmt::format("--shard {} is not a shard; write K/N, as in --shard 3/64", word));
    if (*of < 1 || *of > Share::most)
        throw InputError(fmt::format("--shard {}: a run is divided into 1 to {} shards", word, Share::most));
    if (*number < 1 || *number > *of)
        throw InputError(fmt::format("--shard {}: the shards of {} are numbered from 1 to {}", word, *of, *of));
    return {*number, *of};
}

std::string folder_name(Share share) { return fmt::format("shard-{}-of-{}", share.number, share.count); }

Shards::Shards(const std::vector<std::string>& folders, const std::string& program) {
    std::vector<fs::path> seen;
    for (const std::string& folder : folders) {
        for (const fs::path& file : state_files(folder)) {
            std::error_code unknown;  // for a file in no folder, such as /proc/self/fd/3
            fs::path real = fs::weakly_canonical(file, unknown);
            if (unknown) real = file;
            if (std::ranges::find(seen, real) != seen.end()) continue;
            seen.push_back(real);
            scene::toml::note_read(file);
            files_.emplace_back(file);
        }
    }
    std::ranges::stable_sort(files_, {}, [](const StateFileReader& f) { return f.head().share.number; });
    check_same_run(program);
    check_complete();
}

void Shards::check_same_run(const std::string& program) const {
    const StateFileReader& first = files_.front();
    for (const StateFileReader& file : files_) {
        const StateHead &head = file.head(), &of = first.head();
        const auto refuse = [&file](const std::string& why) {
            throw InputError(file.path().string() + ": " + why + "; nothing was joined");
        };
        if (head.program != program) refuse("was made by " + head.program + ", but this is " + program);
        if (head.command != of.command)
            refuse(fmt::format("is a shard of another run: of `{}`, but {} is a shard of `{}`", head.command,
                               first.path().string(), of.command));
        if (head.share.count != of.share.count)
            refuse(fmt::format("is shard {}, but {} is shard {}: the run was divided in two ways",
                               shard_text(head.share), first.path().string(), shard_text(of.share)));
        if (head.inputs != of.inputs)
            refuse(fmt::format(
                "was measured with other files than {}: a scene, a sweep, a file of rays or of claims, or a "
                "library changed between them",
                first.path().string()));
    }
}

void Shards::check_complete() const {
    const std::uint64_t of = files_.front().head().share.count;
    for (std::size_t i = 1; i < files_.size(); ++i) {
        if (files_[i].head().share == files_[i - 1].head().share)
            throw InputError(fmt::format("{}: is shard {}, and so is {}; name one of them; nothing was joined",
                                         files_[i].path().string(), shard_text(files_[i].head().share),
                                         files_[i - 1].path().string()));
    }
    if (files_.size() == of) return;
    std::vector<std::uint64_t> missing;
    std::size_t at = 0;
    for (std::uint64_t number = 1; number <= of && missing.size() < 1000; ++number) {
        if (at < files_.size() && files_[at].head().share.number == number) ++at;
        else missing.push_back(number);
    }
    const bool one = of - files_.size() == 1;
    throw InputError(fmt::format(
        "{} of {} shards {} missing: {}; nothing was joined. Run `{} --shard {}/{}` for {}, with the {} of the others",
        of - files_.size(), of, one ? "is" : "are", ranges_text(missing), command(),
        one ? std::to_string(missing.front()) : "K", of, one ? "it" : "each of them",
        command().starts_with("lostbits check ") ? "--report" : "-o"));
}

void Shards::check_inputs(std::uint64_t inputs) const {
    if (inputs == files_.front().head().inputs) return;
    throw InputError(files_.front().path().string() +
                     ": the files that its run read have changed: a scene, a sweep, a file of rays or of claims, or a "
                     "library; join the shards where the old files are, or run the shards again");
}

void Shards::check_jobs(const std::vector<std::string>& jobs) const {
    for (const StateFileReader& file : files_) {
        if (!std::ranges::is_permutation(file.names(), jobs)) file.damaged();
    }
}

void Shards::each(const std::string& name, const std::function<void(output::shard::BitReader&)>& take) {
    for (StateFileReader& file : files_) {
        bool any = false;
        while (file.next(name, take)) any = true;
        file.rest();
        if (!any) file.damaged();
    }
}

void Shards::check_end() const {
    for (const StateFileReader& file : files_) {
        if (!file.is_at_end()) file.damaged();
    }
}

Division::Division(const fs::path& folder, const StateHead& head)
    : share_(head.share),
      file_(std::make_unique<output::shard::StateFileWriter>(folder / output::shard::state_file_name, head)) {}

void Division::finish() {
    if (joined_) joined_->check_end();
    if (file_) file_->close();
}

}  // namespace lostbits::analysis::shard
