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
std::vector<fs::path> state_files(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) return {path};
    if (fs::is_regular_file(path / output::shard::state_file_name, ignored))
        return {path / output::shard::state_file_name};
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(path, ignored)) {
        const fs::path file = entry.path() / output::shard::state_file_name;
        if (fs::is_regular_file(file, ignored)) found.push_back(file);
    }
    if (!fs::exists(path, ignored))
        throw InputError(path.string() +
                         ": does not exist; name the folder given by -o to the runs with --shard, or the shard-K-of-N "
                         "folders in it");
    if (found.empty())
        throw InputError(path.string() +
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

Share parse_share(const std::string& text) {
    const std::size_t slash = text.find('/');
    const auto number = whole_number(std::string_view(text).substr(0, slash));
    const auto count =
        slash == std::string::npos ? std::nullopt : whole_number(std::string_view(text).substr(slash + 1));
    if (!number || !count)
        throw InputError(fmt::format("--shard {}: is not a shard; write K/N, as in --shard 3/64", text));
    if (*count < 1 || *count > Share::max_count)
        throw InputError(fmt::format("--shard {}: a run is divided into 1 to {} shards", text, Share::max_count));
    if (*number < 1 || *number > *count)
        throw InputError(fmt::format("--shard {}: the shards of {} are numbered from 1 to {}", text, *count, *count));
    return {*number, *count};
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
            scene::toml::reserve_for_reading(file);
            files_.emplace_back(file);
        }
    }
    std::ranges::stable_sort(files_, {}, [](const StateFileReader& f) { return f.head().share.number; });
    require_same_run(program);
    require_complete();
}

void Shards::require_same_run(const std::string& program) const {
    const StateFileReader& first = files_.front();
    for (const StateFileReader& file : files_) {
        const StateHead &head = file.head(), &first_head = first.head();
        const auto refuse = [&file](const std::string& why) {
            throw InputError(file.path().string() + ": " + why + "; nothing was joined");
        };
        if (head.program != program) refuse("was made by " + head.program + ", but this is " + program);
        if (head.command != first_head.command)
            refuse(fmt::format("is a shard of another run: of `{}`, but {} is a shard of `{}`", head.command,
                               first.path().string(), first_head.command));
        if (head.share.count != first_head.share.count)
            refuse(fmt::format("is shard {}, but {} is shard {}: the run was divided in two ways",
                               shard_text(head.share), first.path().string(), shard_text(first_head.share)));
        if (head.inputs != first_head.inputs)
            refuse(fmt::format(
                "was measured with other files than {}: a scene, a sweep, a file of rays or of claims, or a "
                "library changed between them",
                first.path().string()));
    }
}

void Shards::require_complete() const {
    const std::uint64_t count = files_.front().head().share.count;
    for (std::size_t i = 1; i < files_.size(); ++i) {
        if (files_[i].head().share == files_[i - 1].head().share)
            throw InputError(fmt::format("{}: is shard {}, and so is {}; name one of them; nothing was joined",
                                         files_[i].path().string(), shard_text(files_[i].head().share),
                                         files_[i - 1].path().string()));
    }
    if (files_.size() == count) return;

    // Names the first missing shards. The files are sorted by number.
    std::vector<std::uint64_t> missing;
    std::size_t index = 0;
    for (std::uint64_t number = 1; number <= count && missing.size() < 1000; ++number) {
        if (index < files_.size() && files_[index].head().share.number == number) ++index;
        else missing.push_back(number);
    }
    const bool is_one = count - files_.size() == 1;
    throw InputError(fmt::format(
        "{} of {} shards {} missing: {}; nothing was joined. Run `{} --shard {}/{}` for {}, with the {} of the others",
        count - files_.size(), count, is_one ? "is" : "are", ranges_text(missing), command(),
        is_one ? std::to_string(missing.front()) : "K", count, is_one ? "it" : "each of them",
        command().starts_with("lostbits check ") ? "--report" : "-o"));
}

void Shards::require_same_inputs(std::uint64_t input_count) const {
    if (input_count == files_.front().head().inputs) return;
    throw InputError(files_.front().path().string() +
                     ": the files that its run read have changed: a scene, a sweep, a file of rays or of claims, or a "
                     "library; join the shards where the old files are, or run the shards again");
}

void Shards::require_same_jobs(const std::vector<std::string>& jobs) const {
    for (const StateFileReader& file : files_) {
        if (!std::ranges::is_permutation(file.names(), jobs)) file.fail_damaged();
    }
}

void Shards::for_each_record(const std::string& name, const std::function<void(output::shard::BitReader&)>& visit) {
    for (StateFileReader& file : files_) {
        bool has_records = false;
        while (file.next(name, visit)) has_records = true;
        file.pause();
        if (!has_records) file.fail_damaged();
    }
}

void Shards::require_end() const {
    for (const StateFileReader& file : files_) {
        if (!file.is_at_end()) file.fail_damaged();
    }
}

Division::Division(const fs::path& folder, const StateHead& head)
    : share_(head.share),
      file_(std::make_unique<output::shard::StateFileWriter>(folder / output::shard::state_file_name, head)) {}

void Division::finish() {
    if (shards_to_join_) shards_to_join_->require_end();
    if (file_) file_->close();
}

}  // namespace lostbits::analysis::shard
