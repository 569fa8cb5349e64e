// Writes and reads the files of shards and of stopped runs.
#include "output/shard/state_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <stdexcept>

#include "number/error.hpp"

namespace lostbits::output::shard {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view heading = "lostbits-shard/3";

template <class Value>
std::string_view bytes_of(const Value& x) {
    return {reinterpret_cast<const char*>(&x), sizeof x};
}

template <class Value>
bool parse_integer(std::string_view text, Value& x, int base = 10) {
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), x, base);
    return error == std::errc{} && stop == text.data() + text.size();
}

/// Writes text on one line: a line break, which a path may hold, becomes `\n`, and a backslash becomes two.
std::string to_one_line(std::string_view text) {
    std::string line;
    for (const char c : text) line += c == '\n' ? "\\n" : c == '\\' ? "\\\\" : std::string(1, c);
    return line;
}

/// Reads text that `to_one_line` wrote.
std::string from_one_line(std::string_view line) {
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const bool is_escaped = line[i] == '\\' && i + 1 < line.size();
        if (is_escaped) ++i;
        text += is_escaped && line[i] == 'n' ? '\n' : line[i];
    }
    return text;
}

}  // namespace

void InputHash::add(std::string_view bytes) {
    for (const char c : bytes) hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 1099511628211U;
}

void InputHash::add_file(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::vector<char> chunk(1 << 16);
    std::uint64_t size = 0;
    while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())), stream.gcount() > 0) {
        add({chunk.data(), static_cast<std::size_t>(stream.gcount())});
        size += static_cast<std::uint64_t>(stream.gcount());
    }
    if (!stream.eof()) throw EnvironmentError(path.string() + ": cannot be read");
    add(bytes_of(size));  // two files one after the other must not hash as one
}

StateFileWriter::StateFileWriter(const fs::path& path, const StateHead& head) : file_(path) {
    write(fmt::format("{}\nprogram {}\ncommand {}\ninputs {:016x}\nshard {}/{}\n\n", heading, head.program,
                      to_one_line(head.command), head.inputs, head.share.number, head.share.count));
}

void StateFileWriter::write(std::string_view bytes) {
    hash_.add(bytes);
    file_.write(bytes);
}

void StateFileWriter::put(std::string_view name, std::string_view bits) {
    const std::lock_guard lock(mutex_);
    write(bytes_of(std::uint64_t{name.size()}));
    write(name);
    write(bytes_of(std::uint64_t{bits.size()}));
    write(bits);
}

void StateFileWriter::close() {
    file_.write(bytes_of(hash_.value()));
    file_.commit();
}

StateFileReader::StateFileReader(fs::path path, std::string damage_text)
    : path_(std::move(path)), damage_text_(std::move(damage_text)), in_(path_, std::ios::binary) {
    if (!in_) throw InputError(path_.string() + ": cannot be read; check the path and its permissions");
    require_matching_hash();
    read_head();
    read_names();
    pause();
}

void StateFileReader::fail_damaged() const { throw InputError(path_.string() + ": " + damage_text_); }

void StateFileReader::require_matching_hash() {
    std::error_code ignored;
    const std::uint64_t size = fs::file_size(path_, ignored);
    if (ignored || size < heading.size() + sizeof(std::uint64_t)) fail_damaged();
    end_ = size - sizeof(std::uint64_t);

    // Hash everything before the stored hash, and compare the two.
    InputHash hash;
    while (position_ < end_) hash.add(read_bytes(std::min<std::uint64_t>(end_ - position_, 1 << 16)));
    std::uint64_t stored_hash = 0;
    if (!in_.read(reinterpret_cast<char*>(&stored_hash), sizeof stored_hash) || stored_hash != hash.value())
        fail_damaged();

    in_.seekg(0);
    position_ = 0;
}

std::string StateFileReader::read_bytes(std::uint64_t size) {
    if (size > end_ - position_) fail_damaged();
    std::string text(size, '\0');
    if (!in_.read(text.data(), static_cast<std::streamsize>(size))) fail_damaged();
    position_ += size;
    return text;
}

std::string StateFileReader::read_line(std::string_view name) {
    std::string text;
    if (!std::getline(in_, text)) fail_damaged();
    position_ += text.size() + 1;
    if (position_ > end_ || !text.starts_with(name))
        fail_damaged();  // a head without an end would run into the hash behind it
    return text.substr(std::min(text.size(), name.size() + 1));
}

void StateFileReader::read_head() {
    const std::string excess = read_line(heading);
    head_.program = read_line("program");
    head_.command = from_one_line(read_line("command"));
    if (!excess.empty() || !parse_integer(read_line("inputs"), head_.inputs, 16)) fail_damaged();

    // `shard 2/5`
    const std::string shard = read_line("shard");
    const std::size_t slash = std::min(shard.find('/'), shard.size() - 1);
    if (!parse_integer(std::string_view(shard).substr(0, slash), head_.share.number) ||
        !parse_integer(std::string_view(shard).substr(slash + 1), head_.share.count))
        fail_damaged();
    const auto [number, count] = head_.share;
    if (number < 1 || number > count || count > measure::shard::Share::max_count) fail_damaged();
    if (!read_line("").empty()) fail_damaged();
}

void StateFileReader::read_names() {
    const std::uint64_t start = position_;
    while (!is_at_end()) {
        const std::string name = read_bytes(read_number());
        if (names_.empty() || names_.back() != name) names_.push_back(name);
        const std::uint64_t size = read_number();
        if (size > end_ - position_ || !in_.seekg(static_cast<std::streamoff>(size), std::ios::cur)) fail_damaged();
        position_ += size;
    }
    position_ = start;
}

std::uint64_t StateFileReader::read_number() {
    const std::string text = read_bytes(sizeof(std::uint64_t));
    std::uint64_t n = 0;
    std::memcpy(&n, text.data(), sizeof n);
    return n;
}

bool StateFileReader::next(std::string_view name, const std::function<void(BitReader&)>& read_record) {
    if (is_at_end()) return false;
    const std::uint64_t start = position_;
    if (!in_.is_open()) {
        in_.open(path_, std::ios::binary);
        in_.seekg(static_cast<std::streamoff>(start));
        if (!in_) throw EnvironmentError(path_.string() + ": cannot be opened again");
    }

    // A record of another name is left for a later call.
    if (read_bytes(read_number()) != name) {
        in_.seekg(static_cast<std::streamoff>(start));
        position_ = start;
        return false;
    }

    try {
        BitReader reader(read_bytes(read_number()));
        read_record(reader);
        if (!reader.is_at_end()) fail_damaged();
    } catch (const std::out_of_range&) {
        fail_damaged();
    }
    return true;
}

void UnfinishedFile::write(std::string_view bits) const {
    StateFileWriter file(path_, head_);
    file.put(job_, bits);
    file.close();
}

void UnfinishedFile::read(const std::function<void(BitReader&)>& read_record) const {
    const auto refuse = [this](const std::string& reason) { throw InputError(path_.string() + ": " + reason); };
    if (!exists()) refuse("does not exist, so there is no unfinished run to continue; leave out --resume");

    StateFileReader file(path_,
                         "is damaged or from another version, so the run cannot continue from it; leave out --resume "
                         "to start over");

    // The run must be the one that was stopped.
    const StateHead& head = file.head();
    if (head.program != head_.program)
        refuse(fmt::format("was written by {}, and this is {}; leave out --resume to start over", head.program,
                           head_.program));
    if (head.command != head_.command)
        refuse(
            fmt::format("belongs to `{}`, and this is `{}`; repeat that command, or leave out --resume to start over",
                        head.command, head_.command));
    if (head.share != head_.share)
        refuse(fmt::format("belongs to shard {}/{}, and this is {}/{}; leave out --resume to start over",
                           head.share.number, head.share.count, head_.share.number, head_.share.count));
    if (head.inputs != head_.inputs)
        refuse(
            "belongs to a run that read other files: the sweep, its scene or a library has changed since; leave out "
            "--resume to start over");

    if (!file.next(job_, read_record) || !file.is_at_end()) file.fail_damaged();
}

}  // namespace lostbits::output::shard
