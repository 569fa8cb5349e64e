#include "scene/ray_file/binary_ray_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "number/error.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::scene::ray_file {

namespace {

/// Returns the format of the answers if they are floats, else the format of the widest number that has a meaning.
Format default_format(const Layout& layout, const std::vector<BinaryColumn>& columns) {
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

BinaryRayFile::BinaryRayFile(const std::filesystem::path& path, const ReadOptions& options, LayoutReader read)
    : RayFile(path), source_(path, options.stop), record_layout_(read(source_, options)) {
    std::vector<std::string> names;
    for (const BinaryColumn& column : record_layout_.columns) names.push_back(column.name);
    layout_.emplace(std::move(names), [this](std::size_t, const std::string& why) {
        throw InputError(record_layout_.error_source + ": " + why);
    });
    finish_header(options, *layout_, default_format(*layout_, record_layout_.columns));
    record_count_ = record_layout_.record_count;
    if (!source_.size()) return;

    // Faults that the size of the file shows are reported before the work.
    const std::uint64_t bytes = *source_.size() - std::min(*source_.size(), record_layout_.begin);
    const std::uint64_t whole_record_count = bytes / record_layout_.record_size;
    if (record_count_ ? whole_record_count < *record_count_ : bytes % record_layout_.record_size != 0)
        fail_short(whole_record_count,
                   bytes - (record_layout_.is_column_major ? 0 : whole_record_count * record_layout_.record_size));
    if (record_count_ && bytes > *record_count_ * record_layout_.record_size)
        throw InputError(fmt::format("{}: byte {}: the header promises {}, but {}; is it one array, written whole?",
                                     source_.name(), record_layout_.begin + *record_count_ * record_layout_.record_size,
                                     text::count_with_noun(*record_count_, "record"),
                                     text::count_with_noun(bytes - *record_count_ * record_layout_.record_size,
                                                           "more byte follows", "more bytes follow")));
    if (!record_count_) record_count_ = whole_record_count;
}

void BinaryRayFile::fail_short(std::uint64_t record, std::uint64_t bytes) const {
    if (record_layout_.is_column_major)
        throw InputError(
            fmt::format("{}: has {} of numbers, but its header promises {} of {} bytes each; it "
                        "was cut short, so write it again",
                        source_.name(), text::count_with_noun(bytes, "byte"),
                        text::count_with_noun(*record_layout_.record_count, "record"), record_layout_.record_size));
    throw InputError(
        fmt::format("{}: record {}: has {} of {} bytes{}; the file was cut short, or its columns are "
                    "different: check their names and types",
                    source_.name(), record, bytes, record_layout_.record_size,
                    record_layout_.record_count
                        ? ", and the header promises " + text::count_with_noun(*record_layout_.record_count, "record")
                        : ""));
}

bool BinaryRayFile::next(std::size_t max_records, Records& records) {
    records.first = next_record_;
    records.bytes.clear();
    if (record_count_)
        max_records = static_cast<std::size_t>(std::min<std::uint64_t>(max_records, *record_count_ - next_record_));
    if (max_records == 0) return false;
    std::size_t bytes_read = 0;
    if (record_layout_.is_column_major) {
        for (const BinaryColumn& column : record_layout_.columns)
            bytes_read += source_.read_at(record_layout_.begin + column.offset + next_record_ * column.type.size,
                                          records.bytes, max_records * column.type.size);
    } else {
        bytes_read = source_.read(records.bytes, max_records * record_layout_.record_size);
    }
    records.count = bytes_read / record_layout_.record_size;
    const std::size_t rest_bytes = bytes_read % record_layout_.record_size;
    if (rest_bytes != 0 || (record_count_ && records.count < max_records))
        fail_short(next_record_ + records.count, rest_bytes);
    next_record_ += records.count;
    return records.count > 0;
}

bool BinaryRayFile::looks_byte_swapped(const Records& records, const std::vector<std::size_t>& columns,
                                       const std::function<bool(double)>& is_usual, std::string& first_unusual) const {
    std::size_t number_count = 0, usual_count = 0, reversed_usual_count = 0;
    for (const std::size_t c : columns) {
        const BinaryColumn& column = record_layout_.columns[c];
        ItemType swapped_type = column.type;
        swapped_type.is_big_endian = !swapped_type.is_big_endian;
        for (std::size_t i = 0; i < std::min<std::size_t>(records.count, 64); ++i) {
            const char* const bytes = records.bytes.data() + i * record_layout_.record_size + column.offset;
            const double x = column.type.read(bytes).value;
            if (x == 0) continue;
            ++number_count;
            usual_count += is_usual(x) ? 1 : 0;
            reversed_usual_count += is_usual(swapped_type.read(bytes).value) ? 1 : 0;
            if (!is_usual(x) && first_unusual.empty())
                first_unusual = fmt::format("record {}: {} is {}", i, column.name, x);
        }
    }
    return number_count >= 6 && 2 * usual_count <= number_count && 10 * reversed_usual_count >= 9 * number_count;
}

void BinaryRayFile::require_not_byte_swapped(const Records& records) const {
    // t may have any value: the number that means a miss may be of any size.
    std::vector<std::size_t> float_columns, hit_columns;
    for (std::size_t c = 0; c < record_layout_.columns.size(); ++c) {
        const auto column_slot = layout_->columns()[c].slot;
        const ItemType& type = record_layout_.columns[c].type;
        if (!column_slot || *column_slot == slot::t || *column_slot == slot::tmin || *column_slot == slot::tmax ||
            type.size < 2)
            continue;
        if (type.kind == ItemType::Kind::floating) float_columns.push_back(c);
        else if (*column_slot == slot::hit) hit_columns.push_back(c);
    }

    // Tests nonzero floats. Lengths of scenes are in this range; at most a sixth of the floats of random bits are.
    std::string first_unusual;
    const bool are_floats_reversed = looks_byte_swapped(
        records, float_columns, [](double x) { return std::fabs(x) > 0x1p-20 && std::fabs(x) < 0x1p20; },
        first_unusual);
    if (!are_floats_reversed) first_unusual.clear();
    const bool is_hit_reversed = looks_byte_swapped(
        records, hit_columns, [](double x) { return x == 1; }, first_unusual);
    if (!are_floats_reversed && !is_hit_reversed) return;

    // Writes the columns again with the other byte order, for the advice.
    std::string columns_text, previous_type;
    bool is_big_endian = false;
    for (const BinaryColumn& column : record_layout_.columns) {
        const bool is_float = column.type.kind == ItemType::Kind::floating;
        ItemType type = column.type;
        if (type.size > 1 && (is_float ? are_floats_reversed : is_hit_reversed || are_floats_reversed))
            type.is_big_endian = !type.is_big_endian;
        is_big_endian |= type.is_big_endian;
        const std::string name = type.name();
        columns_text += (columns_text.empty() ? "" : ",") + column.name + (name == previous_type ? "" : ":" + name);
        previous_type = name;
    }

    throw InputError(
        fmt::format("{}: {}; most numbers look wrong in this byte order and normal in the other, so the {} "
                    "significant byte comes first; write --columns {}",
                    source_.name(), first_unusual, is_big_endian ? "most" : "least", columns_text));
}

std::vector<BinaryRayFile::ColumnReader> BinaryRayFile::make_column_readers(const Records& records) const {
    std::vector<ColumnReader> readers;
    std::size_t begin = 0;
    for (std::size_t c = 0; c < record_layout_.columns.size(); ++c) {
        const BinaryColumn& column = record_layout_.columns[c];
        const LayoutColumn& layout_column = layout_->columns()[c];
        const std::size_t offset = record_layout_.is_column_major ? begin : column.offset;
        begin += records.count * column.type.size;
        const bool is_kept = !layout_column.slot && !layout_column.is_skipped && settings().keeps_own_columns;
        if (!layout_column.slot && !is_kept) continue;
        readers.push_back(
            {records.bytes.data() + offset,
             record_layout_.is_column_major ? column.type.size : static_cast<std::size_t>(record_layout_.record_size),
             column.type, layout_column.slot, is_kept});
    }
    return readers;
}

void BinaryRayFile::put_rounded(const ColumnReader& reader, std::uint64_t record, ChunkWriter& writer) const {
    const auto [value, exact] = reader.type.read(reader.bytes);
    const double stored = number_in(value, format());
    if (std::isinf(stored) && !std::isinf(value))
        throw InputError(
            fmt::format("{}: record {}: {} is {}, larger than the largest number of {}; name the "
                        "format that the answers were computed in with --answer-format",
                        source_.name(), record, record_layout_.columns[layout_->index_of(*reader.slot)].name, value,
                        format().name));
    writer.put(*reader.slot, stored, exact && (stored == value || std::isnan(value)));
}

Chunk BinaryRayFile::decode(const Records& records) const {
    if (records.first == 0 && !record_layout_.record_count) require_not_byte_swapped(records);
    Chunk chunk;
    chunk.first = records.first;
    std::vector<ColumnReader> readers = make_column_readers(records);
    ChunkWriter writer(*layout_, settings(), records.count, chunk);

    for (std::size_t i = 0; i < records.count; ++i) {
        for (ColumnReader& reader : readers) {
            if (reader.is_kept) chunk.kept.push_back(reader.type.text(reader.bytes));
            else put_rounded(reader, records.first + i, writer);
            reader.bytes += reader.step;
        }
        writer.end_record([&](std::size_t) { return fmt::format("{}: record {}", source_.name(), records.first + i); });
    }
    return chunk;
}

namespace {

/// Reads `ox:f32,oy,oz`. A column without a type has the type of the column before it.
std::vector<BinaryColumn> read_columns(const std::string& text) {
    std::vector<BinaryColumn> columns;
    std::optional<ItemType> type;
    std::uint64_t offset = 0;
    for (std::size_t begin = 0; begin <= text.size();) {
        // Takes the text up to the next comma, without the blanks around it.
        const std::size_t end = std::min(text.find(',', begin), text.size());
        std::string column_text = text.substr(begin, end - begin);
        column_text.erase(0, column_text.find_first_not_of(' '));
        column_text.erase(column_text.find_last_not_of(' ') + 1);

        // Splits it into the name and the type.
        const auto colon = column_text.find(':');
        const std::string name = column_text.substr(0, colon);
        if (colon != std::string::npos) {
            const std::string type_name = column_text.substr(colon + 1);
            type = find_item_type(type_name);
            if (!type)
                throw InputError(fmt::format("--columns: {}: \"{}\" is not a type of numbers; write {}", name,
                                             type_name, item_type_advice));
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

RecordLayout read_raw_layout(toml::ByteSource& source, const ReadOptions& options) {
    if (options.columns.empty())
        throw InputError(source.name() +
                         ": raw numbers have no header; name them and their types with "
                         "--columns ox:f32,oy,oz,dx,dy,dz,hit:u8,t:f32");
    RecordLayout raw{.columns = read_columns(options.columns), .begin = options.skip, .error_source = "--columns"};
    for (const BinaryColumn& column : raw.columns) raw.record_size += column.type.size;
    if (source.size() && *source.size() < options.skip)
        throw InputError(fmt::format("{}: --skip {} is beyond its end: it has {} bytes", source.name(), options.skip,
                                     *source.size()));
    std::string skipped;
    for (std::uint64_t bytes_left = options.skip; bytes_left > 0; skipped.clear()) {
        const std::size_t bytes_read =
            source.read(skipped, static_cast<std::size_t>(std::min<std::uint64_t>(bytes_left, 1U << 20)));
        if (bytes_read == 0) throw InputError(source.name() + ": ends before the bytes of --skip do");
        bytes_left -= bytes_read;
    }
    return raw;
}

}  // namespace lostbits::scene::ray_file
