// Writes the headers and the compressed blocks of EXR files.
#include "output/image/exr_book.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>
#include <set>
#include <stdexcept>

#include "output/file/result_folder.hpp"

namespace lostbits::output::image {

static_assert(std::endian::native == std::endian::little, "samples are written as they lie in memory");

namespace {

constexpr int block_lines = 16;  // lines per ZIP block
constexpr int zlib_level = 1;
constexpr std::size_t sample_bytes = 4;

// Writers of the header's fields.
template <class Number>
void append_number(std::string& out, Number x) {
    char bytes[sizeof x];
    std::memcpy(bytes, &x, sizeof x);
    out.append(bytes, sizeof x);
}

void append_name(std::string& out, const std::string& name) { out.append(name.c_str(), name.size() + 1); }

void append_attribute(std::string& out, const std::string& name, const char* type, const std::string& value) {
    append_name(out, name);
    append_name(out, type);
    append_number(out, static_cast<std::int32_t>(value.size()));
    out += value;
}

template <class Number>
std::string to_bytes(std::initializer_list<Number> numbers) {
    std::string bytes;
    for (const Number x : numbers) append_number(bytes, x);
    return bytes;
}

int block_count(const ExrSpec& spec) { return (spec.height + block_lines - 1) / block_lines; }

/// Indices of the channels in the spec, sorted by name as in the file.
std::vector<std::size_t> sorted_channels(const ExrSpec& spec) {
    std::vector<std::size_t> indices(spec.channels.size());
    std::iota(indices.begin(), indices.end(), std::size_t{0});
    std::ranges::sort(indices, {}, [&spec](std::size_t c) { return spec.channels[c].name; });
    return indices;
}

std::string channel_list(const ExrSpec& spec) {
    std::string list;
    for (const std::size_t c : sorted_channels(spec)) {
        append_name(list, spec.channels[c].name);
        append_number(list, std::int32_t{spec.channels[c].type == Channel::Type::u32 ? 0 : 2});
        append_number(list, std::int32_t{0});  // not perceptually linear, and three reserved bytes
        list += to_bytes<std::int32_t>({1, 1});
    }
    list += '\0';
    return list;
}

std::string header_bytes(const ExrPart& part) {
    const ExrSpec& spec = part.spec;
    const auto window = to_bytes<std::int32_t>({0, 0, spec.width - 1, spec.height - 1});
    std::string out;

    // Attributes that every part has.
    append_attribute(out, "channels", "chlist", channel_list(spec));
    append_attribute(out, "compression", "compression", "\3");
    append_attribute(out, "dataWindow", "box2i", window);
    append_attribute(out, "displayWindow", "box2i", window);
    append_attribute(out, "lineOrder", "lineOrder", std::string(1, '\0'));
    append_attribute(out, "pixelAspectRatio", "float", to_bytes({1.0F}));
    append_attribute(out, "screenWindowCenter", "v2f", to_bytes({0.0F, 0.0F}));
    append_attribute(out, "screenWindowWidth", "float", to_bytes({1.0F}));

    // Attributes of a file with several parts, and those of the caller.
    if (!part.name.empty()) {
        append_attribute(out, "name", "string", part.name);
        append_attribute(out, "type", "string", "scanlineimage");
        append_attribute(out, "chunkCount", "int", to_bytes<std::int32_t>({block_count(spec)}));
    }
    for (const auto& [name, value] : spec.attributes) append_attribute(out, name, "string", value);
    out += '\0';
    return out;
}

bool has_long_name(const ExrPart& part) {
    const auto is_long = [](const auto& name) { return name.size() > 31; };
    return std::ranges::any_of(part.spec.channels, is_long, &Channel::name) ||
           std::ranges::any_of(part.spec.attributes, is_long, [](const auto& a) { return a.first; });
}

/// Compresses a block as EXR's ZIP does, in three steps: the bytes at even indices come first, then those at odd
/// indices; each byte is replaced by its difference from the byte before it, plus 128; the result is deflated. A block
/// that would not get smaller is returned as it is. A reader recognises such a block by its size.
std::string compress_block(const std::string& raw) {
    std::string reordered(raw.size(), '\0');
    const std::size_t odd_begin = (raw.size() + 1) / 2;
    for (std::size_t i = 0; i < raw.size(); ++i) reordered[i / 2 + (i % 2 ? odd_begin : 0)] = raw[i];

    unsigned char previous = static_cast<unsigned char>(reordered[0]);
    for (std::size_t i = 1; i < reordered.size(); ++i) {
        const auto byte = static_cast<unsigned char>(reordered[i]);
        reordered[i] = static_cast<char>(static_cast<unsigned char>(byte - previous + 128));
        previous = byte;
    }

    uLongf size = compressBound(static_cast<uLong>(reordered.size()));
    std::string deflated(size, '\0');
    const int code =
        compress2(reinterpret_cast<Bytef*>(deflated.data()), &size, reinterpret_cast<const Bytef*>(reordered.data()),
                  static_cast<uLong>(reordered.size()), zlib_level);
    if (code != Z_OK) throw std::runtime_error("zlib could not deflate a block: code " + std::to_string(code));
    if (size >= raw.size()) return raw;
    deflated.resize(size);
    return deflated;
}

}  // namespace

struct ExrBook::PartState {
    ExrPart part;
    std::vector<std::size_t> channels;       ///< in the file's order
    std::string block = {};                  ///< lines of the block that is being filled
    int received_lines = 0;                  ///< number of lines received so far
    std::vector<std::int64_t> offsets = {};  ///< offsets of the blocks in the file
};

namespace {

/// Throws std::logic_error unless the parts have names and channels of their own, and pixels of one size.
void require_valid_parts(const std::string& path, const std::vector<ExrPart>& parts) {
    if (parts.empty()) throw std::logic_error(path + ": an EXR without parts");
    std::set<std::string> names;
    for (const ExrPart& part : parts) {
        const ExrSpec& spec = part.spec;
        std::set<std::string_view> channels;
        for (const Channel& channel : spec.channels) channels.insert(channel.name);
        if (channels.size() != spec.channels.size())
            throw std::logic_error(path + ": part " + part.name + " has two channels with the same name");
        if (spec.width <= 0 || spec.height <= 0 || spec.channels.empty() || !names.insert(part.name).second ||
            spec.width != parts.front().spec.width || spec.height != parts.front().spec.height)
            throw std::logic_error(path + ": part " + part.name + " has no pixels, a name or a size of its own");
        if (part.name.empty() && parts.size() > 1) throw std::logic_error(path + ": a part without a name");
    }
}

}  // namespace

ExrBook::ExrBook(const std::filesystem::path& path, std::vector<ExrPart> parts) : path_(path.string()), file_(path) {
    require_valid_parts(path_, parts);

    // The order of the blocks in the file.
    for (std::size_t p = 0; p < parts.size(); ++p) {
        for (int block = 0; block < block_count(parts[p].spec); ++block) order_.emplace_back(parts[p].run, block, p);
    }
    std::ranges::sort(order_);

    for (ExrPart& part : parts) {
        file::add_provenance(path, part.spec.attributes);
        std::vector<std::size_t> channels = sorted_channels(part.spec);
        part_states_.push_back({std::move(part), std::move(channels)});
    }
    write_header();
}

ExrBook::~ExrBook() = default;

bool ExrBook::has_parts() const { return !part_states_.front().part.name.empty(); }

void ExrBook::write_header() {
    constexpr std::int32_t magic = 20000630, version = 2, long_names = 0x400, several_parts = 0x1000;
    const bool has_long_names =
        std::ranges::any_of(part_states_, [](const PartState& state) { return has_long_name(state.part); });
    std::string header = to_bytes<std::int32_t>(
        {magic, version | (has_parts() ? several_parts : 0) | (has_long_names ? long_names : 0)});
    for (const PartState& state : part_states_) header += header_bytes(state.part);
    if (has_parts()) header += '\0';

    file_.seek(0);
    file_.write(header);
    for (PartState& state : part_states_) {
        state.offsets.resize(static_cast<std::size_t>(block_count(state.part.spec)));
        file_.write(std::as_bytes(std::span(state.offsets)));
    }
}

void ExrBook::write_rows(std::size_t part, int y_begin, int row_count, std::span<const std::byte> pixels) {
    PartState& state = part_states_.at(part);
    const ExrSpec& spec = state.part.spec;
    const auto width = static_cast<std::size_t>(spec.width);
    const std::size_t pixel_bytes = spec.channels.size() * sample_bytes;
    if (y_begin != state.received_lines || row_count < 0 || row_count > spec.height - state.received_lines ||
        pixels.size() != static_cast<std::size_t>(row_count) * width * pixel_bytes)
        throw std::logic_error(path_ + ": rows of part " + state.part.name + " out of order or of another size");

    for (int y = 0; y < row_count; ++y, pixels = pixels.subspan(width * pixel_bytes)) {
        for (const std::size_t c : state.channels) {
            const std::size_t start = state.block.size();
            state.block.resize(start + width * sample_bytes);
            for (std::size_t x = 0; x < width; ++x)
                std::memcpy(state.block.data() + start + x * sample_bytes,
                            pixels.data() + x * pixel_bytes + c * sample_bytes, sample_bytes);
        }

        // Compresses a block when its last line has come.
        ++state.received_lines;
        if (state.received_lines % block_lines != 0 && state.received_lines != spec.height) continue;
        add_block(part, (state.received_lines - 1) / block_lines, compress_block(state.block));
        state.block.clear();
    }
}

void ExrBook::add_block(std::size_t part, int block, std::string bytes) {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    waiting_blocks_.emplace(BlockPosition(part_states_[part].part.run, block, part), std::move(bytes));
    try {
        write_waiting_blocks();
    } catch (...) {
        failure_ = std::current_exception();
        throw;
    }
}

void ExrBook::write_waiting_blocks() {
    for (auto entry = waiting_blocks_.begin(); entry != waiting_blocks_.end() && entry->first == order_[next_in_order_];
         entry = waiting_blocks_.erase(entry), ++next_in_order_) {
        const auto& [run, block, part] = entry->first;
        part_states_[part].offsets[block] = file_.tell();
        if (has_parts()) file_.write(to_bytes({static_cast<std::int32_t>(part)}));
        file_.write(to_bytes({block * block_lines, static_cast<std::int32_t>(entry->second.size())}));
        file_.write(entry->second);
    }
}

void ExrBook::close() {
    const std::lock_guard lock(mutex_);
    if (next_in_order_ != order_.size())
        throw std::logic_error(path_ + ": closed after " + std::to_string(next_in_order_) + " of " +
                               std::to_string(order_.size()) + " blocks");
    next_in_order_ = 0;
    write_header();
    file_.commit();
}

}  // namespace lostbits::output::image
