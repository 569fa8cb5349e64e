// What raw numbers and arrays have in common: columns of fixed size, record after record or column after column.
#pragma once

#include <functional>
#include <vector>

#include "scene/dump/dump.hpp"
#include "scene/dump/item_type.hpp"
#include "scene/toml/byte_source.hpp"

namespace lostbits::scene::dump {

/// A column as it lies in a file of numbers.
struct BinaryColumn {
    std::string name;
    ItemType type;
    std::uint64_t offset = 0;  ///< in a record; of columns that lie apart, in the file behind its header
};

/// How numbers lie in a file, as its header tells.
struct Lie {
    std::vector<BinaryColumn> columns;
    std::uint64_t begin = 0;                    ///< of the first record, in bytes; the source stands there
    std::uint64_t record_size = 0;              ///< in bytes
    std::optional<std::uint64_t> records = {};  ///< as the header has it; nothing: as many as there are
    bool apart = false;                         ///< column after column; `records` is known then
    std::optional<std::pair<int, int>> picture = {};
    std::string blamed = {};  ///< who is wrong where the columns are none of rays
};
using ReadLie = Lie (*)(toml::ByteSource& source, const DumpOptions& options);

/// Without a header: `--columns` says what they are, `ox:f32,oy,oz,…`; a column without a type has that of the one
/// before it.
Lie read_raw(toml::ByteSource& source, const DumpOptions& options);

/// An array of numpy, plain or of records with named fields, versions 1 to 3. The last axis of a plain array is the
/// columns, which `--columns` names; the axes before it, or all axes of an array of records, are rays, and two of them
/// are a picture of so many rows and columns.
Lie read_npy(toml::ByteSource& source, const DumpOptions& options);

class BinaryDump final : public Dump {
public:
    BinaryDump(const std::filesystem::path& path, const DumpOptions& options, ReadLie read);
    [[nodiscard]] const Layout& layout() const override { return *layout_; }
    [[nodiscard]] std::optional<std::uint64_t> size() const override { return records_; }
    [[nodiscard]] std::optional<std::pair<int, int>> picture() const override { return lie_.picture; }
    [[nodiscard]] std::uint64_t bytes() const override { return source_.size().value_or(0); }
    bool next(std::size_t most, Records& records) override;
    [[nodiscard]] Chunk decode(const Records& records) const override;

private:
    /// Whether nearly all numbers of some columns are usual with their bytes in the other order, and not so; `strange`:
    /// where the first of them is.
    [[nodiscard]] bool is_reversed(const Records& records, const std::vector<std::size_t>& columns,
                                   const std::function<bool(double)>& is_usual, std::string& strange) const;
    /// InputError where the numbers of these records, raw ones, have their bytes in the other order.
    void refuse_reversed(const Records& records) const;
    [[noreturn]] void fail_short(std::uint64_t record, std::uint64_t bytes) const;

    toml::ByteSource source_;
    Lie lie_;
    std::optional<Layout> layout_;
    std::optional<std::uint64_t> records_;
    std::uint64_t record_ = 0;
};

}  // namespace lostbits::scene::dump
