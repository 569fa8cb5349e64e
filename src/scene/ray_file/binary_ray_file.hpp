// Reads raw numbers and numpy arrays: columns of fixed size, record after record or column after column.
#pragma once

#include <functional>
#include <vector>

#include "scene/ray_file/item_type.hpp"
#include "scene/ray_file/ray_file.hpp"
#include "scene/toml/byte_source.hpp"

namespace lostbits::scene::ray_file {

/// A column of a binary file.
struct BinaryColumn {
    std::string name;
    ItemType type;
    std::uint64_t offset = 0;  ///< in a record; if `is_column_major`, in the file after its header
};

/// The layout of the numbers in a file, as its header gives it.
struct RecordLayout {
    std::vector<BinaryColumn> columns;
    std::uint64_t begin = 0;                         ///< of the first record, in bytes; the source is at this position
    std::uint64_t record_size = 0;                   ///< in bytes
    std::optional<std::uint64_t> record_count = {};  ///< from the header; absent: all records of the file
    bool is_column_major = false;                    ///< column after column; `record_count` is known then
    std::optional<std::pair<int, int>> picture = {};
    std::string error_source = {};  ///< name in the errors about columns that are not those of rays
};
using LayoutReader = RecordLayout (*)(toml::ByteSource& source, const ReadOptions& options);

/// Reads the layout of a file without a header. `--columns` gives the columns, `ox:f32,oy,oz,…`. A column without a
/// type has the type of the column before it.
RecordLayout read_raw_layout(toml::ByteSource& source, const ReadOptions& options);

/// Reads the header of a numpy array, plain or of records with named fields, versions 1 to 3. The last axis of a plain
/// array is the columns, which `--columns` names. The axes before it, or all axes of an array of records, are rays;
/// two of them are a picture with that many rows and columns.
RecordLayout read_npy_layout(toml::ByteSource& source, const ReadOptions& options);

/// A file of raw numbers, or a numpy array.
class BinaryRayFile final : public RayFile {
public:
    BinaryRayFile(const std::filesystem::path& path, const ReadOptions& options, LayoutReader read);
    [[nodiscard]] const Layout& layout() const override { return *layout_; }
    [[nodiscard]] std::optional<std::uint64_t> size() const override { return record_count_; }
    [[nodiscard]] std::optional<std::pair<int, int>> picture() const override { return record_layout_.picture; }
    [[nodiscard]] std::uint64_t bytes() const override { return source_.size().value_or(0); }
    bool next(std::size_t max_records, Records& records) override;
    [[nodiscard]] Chunk decode(const Records& records) const override;

private:
    /// True if the numbers of these columns look byte-swapped: nearly all of them have usual values only after their
    /// bytes are reversed. `first_unusual` is set to a description of the first unusual number.
    [[nodiscard]] bool looks_byte_swapped(const Records& records, const std::vector<std::size_t>& columns,
                                          const std::function<bool(double)>& is_usual,
                                          std::string& first_unusual) const;
    /// Throws InputError if these records, which are raw numbers, look byte-swapped.
    void require_not_byte_swapped(const Records& records) const;
    [[noreturn]] void fail_short(std::uint64_t record, std::uint64_t bytes) const;

    /// Walks through the numbers of one column.
    struct ColumnReader {
        const char* bytes;  ///< the next number
        std::size_t step;   ///< in bytes, from one record to the next
        ItemType type;
        std::optional<std::size_t> slot;
        bool is_kept;  ///< true for a column of the user's own, whose text is stored
    };
    /// Makes readers for the columns that have a slot or are kept.
    [[nodiscard]] std::vector<ColumnReader> make_column_readers(const Records& records) const;
    /// Stores the reader's number in its slot, rounded to the format. Throws InputError if it overflows.
    void put_rounded(const ColumnReader& reader, std::uint64_t record, ChunkWriter& writer) const;

    toml::ByteSource source_;
    RecordLayout record_layout_;
    std::optional<Layout> layout_;
    std::optional<std::uint64_t> record_count_;
    std::uint64_t next_record_ = 0;
};

}  // namespace lostbits::scene::ray_file
