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
constexpr int level = 1;
constexpr std::size_t sample_bytes = 4;

// Writers of the header's fields.
template <class Number>
void put(std::string& out, Number x) {
    char bytes[sizeof x];
    std::memcpy(bytes, &x, sizeof x);
    out.append(bytes, sizeof x);
}

void put_name(std::string& out, const std::string& name) { out.append(name.c_str(), name.size() + 1); }

void put_attribute(std::string& out, const std::string& name, const char* type, const std::string& value) {
    put_name(out, name);
    put_name(out, type);
    put(out, static_cast<std::int32_t>(value.size()));
    out += value;
}

template <class Number>
std::string words(std::initializer_list<Number> numbers) {
    std::string bytes;
    for (const Number x : numbers) put(bytes, x);
    return bytes;
}

int blocks_of(const ExrSpec& spec) { return (spec.height + block_lines - 1) / block_lines; }

/// Indices of the channels in the spec, sorted by name as in the file.
std::vector<std::size_t> sorted_channels(const ExrSpec& spec) {
    std::vector<std::size_t> places(spec.channels.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::ranges::sort(places, {}, [&spec](std::size_t c) { return spec.channels[c].name; });
    return places;
}

std::string channel_list(const ExrSpec& spec) {
    std::string list;
    for (const std::size_t c : sorted_channels(spec)) {
        put_name(list, spec.channels[c].name);
        put(list, std::int32_t{spec.channels[c].type == Channel::Type::u32 ? 0 : 2});
        put(list, std::int32_t{0});  // not perceptually linear, and three reserved bytes
        list += words<std::int32_t>({1, 1});
    }
    list += '\0';
    return list;
}

std::string header_of(const ExrPart& part) {
    const ExrSpec& spec = part.spec;
    const auto window = words<std::int32_t>({0, 0, spec.width - 1, spec.height - 1});
    std::string out;
    put_attribute(out, "channels", "chlist", channel_list(spec));
    put_attribute(out, "compression", "compression", "\3");
    put_attribute(out, "dataWindow", "box2i", window);
    put_attribute(out, "displayWindow", "box2i", window);
    put_attribute(out, "lineOrder", "lineOrder", std::string(1, '\0'));
    put_attribute(out, "pixelAspectRatio", "float", words({1.0F}));
    put_attribute(out, "screenWindowCenter", "v2f", words({0.0F, 0.0F}));
    put_attribute(out, "screenWindowWidth", "float", words({1.0F}));
    if (!part.name.empty()) {
        put_attribute(out, "name", "string", part.name);
        put_attribute(out, "type", "string", "scanlineimage");
        put_attribute(out, "chunkCount", "int", words<std::int32_t>({blocks_of(spec)}));
    }
    for (const auto& [name, value] : spec.attributes) put_attribute(out, name, "string", value);
    out += '\0';
    return out;
}

bool has_long_name(const ExrPart& part) {
    const auto is_long = [](const auto& named) { return named.size() > 31; };
    return std::ranges::any_of(part.spec.channels, is_long, &Channel::name) ||
           std::ranges::any_of(part.spec.attributes, is_long, [](const auto& a) { return a.first; });
}

/// Compresses a block: bytes at even indices first, then those at odd ones; each replaced by its difference from the
/// one before plus 128; then deflated. A block that would not get smaller stays as it is; a reader sees that by its
/// size.
std::string compressed(const std::string& raw) {
    std::string parted(raw.size(), '\0');
    const std::size_t half = (raw.size() + 1) / 2;
    for (std::size_t i = 0; i < raw.size(); ++i) parted[i / 2 + (i % 2 ? half : 0)] = raw[i];
    unsigned char before = static_cast<unsigned char>(parted[0]);
    for (std::size_t i = 1; i < parted.size(); ++i) {
        const auto byte = static_cast<unsigned char>(parted[i]);
        parted[i] = static_cast<char>(static_cast<unsigned char>(byte - before + 128));
        before = byte;
    }
    uLongf size = compressBound(static_cast<uLong>(parted.size()));
    std::string packed(size, '\0');
    const int code = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(parted.data()), static_cast<uLong>(parted.size()), level);
    if (code != Z_OK) throw std::runtime_error("zlib could not deflate a block: code " + std::to_string(code));
    if (size >= raw.size()) return raw;
    packed.resize(size);
    return packed;
}

}  // namespace

struct ExrBook::Page {
    ExrPart part;
    std::vector<std::size_t> channels;       ///< in the file's order
    std::string block = {};                  ///< lines of the block that is being filled
    int lines = 0;                           ///< number of lines received so far
    std::vector<std::int64_t> offsets = {};  ///< of the blocks in the file
};

ExrBook::ExrBook(const std::filesystem::path& path, std::vector<ExrPart> parts) : path_(path.string()), out_(path) {
    std::set<std::string> names;
    for (ExrPart& part : parts) {
        file::add_generator(path, part.spec.attributes);
        const ExrSpec& spec = part.spec;
        std::set<std::string_view> channels;
        for (const Channel& channel : spec.channels) channels.insert(channel.name);
        if (channels.size() != spec.channels.size())
            throw std::logic_error(path_ + ": part " + part.name + " has two channels with the same name");
        if (spec.width <= 0 || spec.height <= 0 || spec.channels.empty() || !names.insert(part.name).second ||
            spec.width != parts.front().spec.width || spec.height != parts.front().spec.height)
            throw std::logic_error(path_ + ": part " + part.name + " has no pixels, a name or a size of its own");
        if (part.name.empty() && parts.size() > 1) throw std::logic_error(path_ + ": a part without a name");
        for (int block = 0; block < blocks_of(spec); ++block)
            order_.emplace_back(part.run, block, static_cast<std::size_t>(&part - parts.data()));
    }
    if (parts.empty()) throw std::logic_error(path_ + ": an EXR without parts");
    std::ranges::sort(order_);
    for (ExrPart& part : parts) {
        std::vector<std::size_t> channels = sorted_channels(part.spec);
        pages_.push_back({std::move(part), std::move(channels)});
    }
    write_header();
}

ExrBook::~ExrBook() = default;

bool ExrBook::has_parts() const { return !pages_.front().part.name.empty(); }

void ExrBook::write_header() {
    constexpr std::int32_t magic = 20000630, version = 2, long_names = 0x400, several_parts = 0x1000;
    const bool is_long = std::ranges::any_of(pages_, [](const Page& page) { return has_long_name(page.part); });
    std::string header =
        words<std::int32_t>({magic, version | (has_parts() ? several_parts : 0) | (is_long ? long_names : 0)});
    for (const Page& page : pages_) header += header_of(page.part);
    if (has_parts()) header += '\0';
    out_.seek(0);
    out_.write(header);
    for (Page& page : pages_) {
        page.offsets.resize(static_cast<std::size_t>(blocks_of(page.part.spec)));
        out_.write(std::as_bytes(std::span(page.offsets)));
    }
}

void ExrBook::write_rows(std::size_t part, int y_begin, int rows, std::span<const std::byte> pixels) {
    Page& page = pages_.at(part);
    const ExrSpec& spec = page.part.spec;
    const auto width = static_cast<std::size_t>(spec.width);
    const std::size_t pixel = spec.channels.size() * sample_bytes;
    if (y_begin != page.lines || rows < 0 || rows > spec.height - page.lines ||
        pixels.size() != static_cast<std::size_t>(rows) * width * pixel)
        throw std::logic_error(path_ + ": rows of part " + page.part.name + " out of order or of another size");
    for (int y = 0; y < rows; ++y, pixels = pixels.subspan(width * pixel)) {
        for (const std::size_t c : page.channels) {
            const std::size_t start = page.block.size();
            page.block.resize(start + width * sample_bytes);
            for (std::size_t x = 0; x < width; ++x)
                std::memcpy(page.block.data() + start + x * sample_bytes, pixels.data() + x * pixel + c * sample_bytes,
                            sample_bytes);
        }
        ++page.lines;
        if (page.lines % block_lines != 0 && page.lines != spec.height) continue;
        add_block(part, (page.lines - 1) / block_lines, compressed(page.block));
        page.block.clear();
    }
}

void ExrBook::add_block(std::size_t part, int block, std::string bytes) {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    waiting_.emplace(BlockPosition(pages_[part].part.run, block, part), std::move(bytes));
    try {
        write_waiting();
    } catch (...) {
        failure_ = std::current_exception();
        throw;
    }
}

void ExrBook::write_waiting() {
    for (auto first = waiting_.begin(); first != waiting_.end() && first->first == order_[next_];
         first = waiting_.erase(first), ++next_) {
        const auto& [run, block, part] = first->first;
        pages_[part].offsets[static_cast<std::size_t>(block)] = out_.tell();
        if (has_parts()) out_.write(words({static_cast<std::int32_t>(part)}));
        out_.write(words({block * block_lines, static_cast<std::int32_t>(first->second.size())}));
        out_.write(first->second);
    }
}

void ExrBook::close() {
    const std::lock_guard lock(mutex_);
    if (next_ != order_.size())
        throw std::logic_error(path_ + ": closed after " + std::to_string(next_) + " of " +
                               std::to_string(order_.size()) + " blocks");
    next_ = 0;
    write_header();
    out_.commit();
}

}  // namespace lostbits::output::image
