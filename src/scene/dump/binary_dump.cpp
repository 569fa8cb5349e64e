#include "scene/dump/binary_dump.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "number/error.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::scene::dump {

namespace {

/// The format of the answers if they are floats, else that of the widest number that has a meaning.
Format own_format(const Layout& layout, const std::vector<BinaryColumn>& columns) {
    std::optional<Format> widest;
    for (std::size_t s = 0; s < slot::count; ++s) {
        if (!layout.has(s)) continue;
        const auto format = columns[layout.index_of(s)].type.format();
        if (format && s == slot::t) return *format;
        if (format && (!widest || format->parameters.precision > widest->parameters.precision)) widest = format;
    }
    return widest.value_or(*find_format("f64"));
}

}  // namespace

BinaryDump::BinaryDump(const std::filesystem::path& path, const DumpOptions& options, LayoutReader read)
    : Dump(path), source_(path, options.stop), record_layout_(read(source_, options)) {
    std::vector<std::string> names;
    for (const BinaryColumn& c : record_layout_.columns) names.push_back(c.name);
    layout_.emplace(std::move(names), [this](std::size_t, const std::string& why) {
        throw InputError(record_layout_.error_source + ": " + why);
    });
    settle(options, *layout_, own_format(*layout_, record_layout_.columns));
    records_ = record_layout_.records;
    if (!source_.size()) return;
    // Faults that the size of the file shows are reported before the work.
    const std::uint64_t bytes = *source_.size() - std::min(*source_.size(), record_layout_.begin);
    const std::uint64_t whole = bytes / record_layout_.record_size;
    if (records_ ? whole < *records_ : bytes % record_layout_.record_size != 0)
        fail_short(whole, bytes - (record_layout_.column_major ? 0 : whole * record_layout_.record_size));
    if (records_ && bytes > *records_ * record_layout_.record_size)
        throw InputError(
            fmt::format("{}: byte {}: {} the last of the {} that the header names; is "
                        "it one array, written whole?",
                        source_.name(), record_layout_.begin + *records_ * record_layout_.record_size,
                        toml::counted(bytes - *records_ * record_layout_.record_size, "byte follows", "bytes follow"),
                        toml::counted(*records_, "record")));
    if (!records_) records_ = whole;
}

void BinaryDump::fail_short(std::uint64_t record, std::uint64_t bytes) const {
    if (record_layout_.column_major)
        throw InputError(
            fmt::format("{}: has {} of numbers, but its header names {} of {} bytes each; it "
                        "was cut short, so write it again",
                        source_.name(), toml::counted(bytes, "byte"), toml::counted(*record_layout_.records, "record"),
                        record_layout_.record_size));
    throw InputError(fmt::format(
        "{}: record {}: has {} of {} bytes{}; the file was cut short, or its columns are "
        "different: check their names and types",
        source_.name(), record, bytes, record_layout_.record_size,
        record_layout_.records ? ", and the header names " + toml::counted(*record_layout_.records, "record") : ""));
}

bool BinaryDump::next(std::size_t most, Records& records) {
    records.first = record_;
    records.bytes.clear();
    if (records_) most = static_cast<std::size_t>(std::min<std::uint64_t>(most, *records_ - record_));
    if (most == 0) return false;
    std::size_t got = 0;
    if (record_layout_.column_major) {
        for (const BinaryColumn& c : record_layout_.columns)
            got += source_.read_at(record_layout_.begin + c.offset + record_ * c.type.size, records.bytes,
                                   most * c.type.size);
    } else {
        got = source_.read(records.bytes, most * record_layout_.record_size);
    }
    records.count = got / record_layout_.record_size;
    const std::size_t rest = got % record_layout_.record_size;
    if (rest != 0 || (records_ && records.count < most)) fail_short(record_ + records.count, rest);
    record_ += records.count;
    return records.count > 0;
}

bool BinaryDump::is_reversed(const Records& records, const std::vector<std::size_t>& columns,
                             const std::function<bool(double)>& is_usual, std::string& strange) const {
    std::size_t numbers = 0, usual = 0, usual_reversed = 0;
    for (const std::size_t c : columns) {
        const BinaryColumn& column = record_layout_.columns[c];
        ItemType reversed = column.type;
        reversed.big_endian = !reversed.big_endian;
        for (std::size_t i = 0; i < std::min<std::size_t>(records.count, 64); ++i) {
            const char* const at = records.bytes.data() + i * record_layout_.record_size + column.offset;
            const double x = column.type.read(at).value;
            if (x == 0) continue;
            ++numbers;
            usual += is_usual(x) ? 1 : 0;
            usual_reversed += is_usual(reversed.read(at).value) ? 1 : 0;
            if (!is_usual(x) && strange.empty()) strange = fmt::format("record {}: {} is {}", i, column.name, x);
        }
    }
    return numbers >= 6 && 2 * usual <= numbers && 10 * usual_reversed >= 9 * numbers;
}

void BinaryDump::refuse_reversed(const Records& records) const {
    // t may have any value: the number that means a miss may be of any size.
    std::vector<std::size_t> floats, whole;
    for (std::size_t c = 0; c < record_layout_.columns.size(); ++c) {
        const auto means = layout_->columns()[c].slot;
        const ItemType& type = record_layout_.columns[c].type;
        if (!means || *means == slot::t || *means == slot::tmin || *means == slot::tmax || type.size < 2) continue;
        if (type.kind == ItemType::Kind::floating) floats.push_back(c);
        else if (*means == slot::hit) whole.push_back(c);
    }
    // Tests nonzero floats. Lengths of scenes are in this range; of random bits, a sixth or less are.
    std::string strange;
    const bool floats_are = is_reversed(
        records, floats, [](double x) { return std::fabs(x) > 0x1p-20 && std::fabs(x) < 0x1p20; }, strange);
    if (!floats_are) strange.clear();
    const bool hit_is = is_reversed(
        records, whole, [](double x) { return x == 1; }, strange);
    if (!floats_are && !hit_is) return;
    std::string words, before;
    bool big_endian = false;
    for (const BinaryColumn& column : record_layout_.columns) {
        const bool is_float = column.type.kind == ItemType::Kind::floating;
        ItemType type = column.type;
        if (type.size > 1 && (is_float ? floats_are : hit_is || floats_are)) type.big_endian = !type.big_endian;
        big_endian |= type.big_endian;
        const std::string name = type.name();
        words += (words.empty() ? "" : ",") + column.name + (name == before ? "" : ":" + name);
        before = name;
    }
    throw InputError(
        fmt::format("{}: {}, and nearly all numbers are as unusual; in the other byte order they have "
                    "usual sizes, so the {} significant byte comes first; write --columns {}",
                    source_.name(), strange, big_endian ? "most" : "least", words));
}

Chunk BinaryDump::decode(const Records& records) const {
    if (records.first == 0 && !record_layout_.records) refuse_reversed(records);
    Chunk chunk;
    chunk.first = records.first;
    struct Reader {
        const char* at;
        std::size_t step;
        ItemType type;
        std::optional<std::size_t> slot;
        bool kept;
    };
    std::vector<Reader> readers;
    std::size_t begin = 0;
    for (std::size_t c = 0; c < record_layout_.columns.size(); ++c) {
        const BinaryColumn& column = record_layout_.columns[c];
        const LayoutColumn& means = layout_->columns()[c];
        const std::size_t offset = record_layout_.column_major ? begin : column.offset;
        begin += records.count * column.type.size;
        const bool kept = !means.slot && !means.skipped && terms().keep;
        if (!means.slot && !kept) continue;
        readers.push_back(
            {records.bytes.data() + offset,
             record_layout_.column_major ? column.type.size : static_cast<std::size_t>(record_layout_.record_size),
             column.type, means.slot, kept});
    }
    ChunkWriter writer(*layout_, terms(), records.count, chunk);
    for (std::size_t i = 0; i < records.count; ++i) {
        for (Reader& reader : readers) {
            if (reader.kept) {
                chunk.kept.push_back(reader.type.text(reader.at));
            } else {
                const auto [value, exact] = reader.type.read(reader.at);
                const double stored = number_in(value, format());
                if (std::isinf(stored) && !std::isinf(value))
                    throw InputError(fmt::format(
                        "{}: record {}: {} is {}, larger than the largest number of {}; name the "
                        "format that the answers were computed in with --answer-format",
                        source_.name(), records.first + i, record_layout_.columns[layout_->index_of(*reader.slot)].name,
                        value, format().name));
                writer.put(*reader.slot, stored, exact && (stored == value || std::isnan(value)));
            }
            reader.at += reader.step;
        }
        writer.end_record([&](std::size_t) { return fmt::format("{}: record {}", source_.name(), records.first + i); });
    }
    return chunk;
}

namespace {

std::vector<BinaryColumn> read_columns(const std::string& text) {
    std::vector<BinaryColumn> columns;
    std::optional<ItemType> type;
    std::uint64_t offset = 0;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        std::string word = text.substr(begin, end - begin);
        word.erase(0, word.find_first_not_of(' '));
        word.erase(word.find_last_not_of(' ') + 1);
        const auto colon = word.find(':');
        const std::string name = word.substr(0, colon);
        if (colon != std::string::npos) {
            const std::string named = word.substr(colon + 1);
            type = find_item_type(named);
            if (!type)
                throw InputError(fmt::format("--columns: {}: \"{}\" is not a type of numbers; write {}", name, named,
                                             known_item_types));
        }
        if (name.empty())
            throw InputError(fmt::format(
                "--columns: a name is missing in front of \"{}\"; write ox:f32,oy,oz,…, and _ for each column to "
                "skip",
                text.substr(begin)));
        if (!type)
            throw InputError(
                fmt::format("--columns: {} has no type; write {}:f32, and all later columns without a type have "
                            "that type too",
                            name, name));
        columns.push_back({name, *type, offset});
        offset += type->size;
        begin = end + 1;
    }
    return columns;
}

}  // namespace

RecordLayout read_raw(toml::ByteSource& source, const DumpOptions& options) {
    if (options.columns.empty())
        throw InputError(source.name() +
                         ": raw numbers have no header; name them and their types with "
                         "--columns ox:f32,oy,oz,dx,dy,dz,hit:u8,t:f32");
    RecordLayout raw{.columns = read_columns(options.columns), .begin = options.skip, .error_source = "--columns"};
    for (const BinaryColumn& c : raw.columns) raw.record_size += c.type.size;
    if (source.size() && *source.size() < options.skip)
        throw InputError(fmt::format("{}: --skip {} is beyond its end: it has {} bytes", source.name(), options.skip,
                                     *source.size()));
    std::string passed;
    for (std::uint64_t left = options.skip; left > 0; passed.clear()) {
        const std::size_t got = source.read(passed, static_cast<std::size_t>(std::min<std::uint64_t>(left, 1U << 20)));
        if (got == 0) throw InputError(source.name() + ": ends before the bytes of --skip do");
        left -= got;
    }
    return raw;
}

}  // namespace lostbits::scene::dump
