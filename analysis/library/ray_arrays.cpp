#include "analysis/library/ray_arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "number/error.hpp"

namespace lostbits::analysis::library {

using scene::ray_file::Chunk;
using scene::ray_file::ChunkWriter;
using scene::ray_file::ReadOptions;
using scene::ray_file::Records;

namespace {

std::vector<std::string> names_of(const std::vector<ArrayColumn>& columns) {
    std::vector<std::string> names;
    for (const ArrayColumn& column : columns) names.push_back(column.name);
    return names;
}

/// The format of t; without t, the format of the widest column.
Format default_format(const std::vector<ArrayColumn>& columns) {
    const auto t = std::ranges::find(columns, "t", &ArrayColumn::name);
    const bool is_wide =
        t != columns.end() ? t->type == ArrayColumn::Type::f64 : std::ranges::any_of(columns, [](const ArrayColumn& c) {
            return c.type == ArrayColumn::Type::f64 && c.stride != 0;
        });
    return *find_format(is_wide ? "f64" : "f32");
}

double exact_number_at(const ArrayColumn& column, std::size_t i) {
    const std::byte* const address = column.data + static_cast<std::ptrdiff_t>(i) * column.stride;
    if (column.type == ArrayColumn::Type::boolean) return *address != std::byte{0} ? 1 : 0;
    if (column.type == ArrayColumn::Type::f32) {
        float x = 0;
        std::memcpy(&x, address, sizeof x);
        return x;
    }
    double x = 0;
    std::memcpy(&x, address, sizeof x);
    return x;
}

/// The shortest decimal that reads back as the number, as in files of rays.
std::string text_at(const ArrayColumn& column, std::size_t i) {
    const double x = exact_number_at(column, i);
    return column.type == ArrayColumn::Type::f32 ? fmt::format("{}", static_cast<float>(x)) : fmt::format("{}", x);
}

}  // namespace

void append_columns(std::vector<ArrayColumn>& target, const lostbits_array& array, std::span<const std::string> names) {
    if (array.data == nullptr) return;
    using Type = ArrayColumn::Type;
    if (array.bits != 8 && array.bits != 32 && array.bits != 64)
        throw InputError("an array of " + names.front() + " has items of " + std::to_string(array.bits) +
                         " bits; give 32 or 64, or 8 for decisions");
    for (std::size_t k = 0; k < names.size(); ++k)
        target.push_back(
            {.name = names[k],
             .data = static_cast<const std::byte*>(array.data) + static_cast<std::ptrdiff_t>(k) * array.item_step,
             .stride = array.step,
             .type = array.bits == 8    ? Type::boolean
                     : array.bits == 32 ? Type::f32
                                        : Type::f64});
}

void require_addressable(const lostbits_array& array, std::size_t row_count, std::size_t column_count,
                         const char* name) {
    constexpr std::size_t max_bytes = PTRDIFF_MAX / 4;
    const auto fits = [](std::size_t count, std::ptrdiff_t step) {
        const std::size_t bytes = step < 0 ? 0 - static_cast<std::size_t>(step) : static_cast<std::size_t>(step);
        return bytes == 0 || count <= max_bytes / bytes;
    };
    if (row_count > max_bytes / sizeof(double) || !fits(row_count, array.step) || !fits(column_count, array.item_step))
        throw InputError(std::string(name) + ": " + std::to_string(row_count) + " rows, " + std::to_string(array.step) +
                         " bytes apart, with items " + std::to_string(array.item_step) +
                         " bytes apart, are more than any memory holds");
}

OpenEnds parse_open_ends(const std::string& text) {
    for (const char* const name : {"none", "tmin", "tmax", "both"})
        if (text == name) return open_ends_named(text);
    throw InputError("open_ends is \"" + text + "\"; write none, tmin, tmax or both");
}

double number_at(const ArrayColumn& column, std::size_t i, const Format& format) {
    return scene::ray_file::number_in(exact_number_at(column, i), format);
}

RayArrays::RayArrays(const std::string& name, std::vector<ArrayColumn> columns, std::size_t count,
                     const ReadOptions& options)
    : RayFile(name, {}),
      columns_(std::move(columns)),
      count_(count),
      layout_(names_of(columns_),
              [&name](std::size_t, const std::string& problem) { throw InputError(name + ": " + problem); }),
      stop_(options.stop) {
    finish_header(options, layout_, default_format(columns_));
}

bool RayArrays::next(std::size_t max_records, Records& records) {
    stop_.check();
    records.first = read_;
    records.count = std::min(max_records, count_ - read_);
    read_ += records.count;
    return records.count > 0;
}

Chunk RayArrays::decode(const Records& records) const {
    Chunk chunk;
    chunk.first = records.first;
    ChunkWriter writer(layout_, settings(), records.count, chunk);
    for (std::size_t i = records.first; i < records.first + records.count; ++i) {
        for (std::size_t c = 0; c < columns_.size(); ++c) {
            const auto slot = layout_.columns()[c].slot;
            if (!slot) {
                chunk.kept.push_back(text_at(columns_[c], i));
                continue;
            }
            const double x = exact_number_at(columns_[c], i), stored = scene::ray_file::number_in(x, format());
            if (std::isinf(stored) && !std::isinf(x))
                throw InputError(fmt::format("{}: ray {}: {} is {}, larger than the largest number of {}", name(), i,
                                             columns_[c].name, x, format().name));
            writer.put(*slot, stored, stored == x || std::isnan(x));
        }
        writer.end_record([&](std::size_t) { return fmt::format("{}: ray {}", name(), i); });
    }
    return chunk;
}

}  // namespace lostbits::analysis::library
