// Writer of EXR files with one part, or with several parts that grow side by side.
//
// OpenImageIO writes one part after the other, so all parts but the first would have to wait on disk, uncompressed:
// 1.7 GB for 41 rows of a map of 1024 × 1024. The file format does not require that order.
//
// OpenEXR's own library, tested at 3.1.5, requires no order in Imf::MultiPartOutputFile, and its files have exactly
// the size of ours. But a call of OutputPart::writePixels holds the lock of the whole file while it compresses. Two
// threads then take as long as one. Blocks lie in the file in the order of the calls, so the bytes differ from run to
// run. In a fixed order, rows would wait uncompressed for their turn and be compressed by the library's own thread
// pool beside ours. The C interface accepts blocks that are compressed already, but only one part after the other
// (EXR_ERR_INCORRECT_PART). Here each thread compresses its own rows and holds no lock meanwhile.
//
// The layout of scan-line parts is that of https://openexr.com/en/latest/OpenEXRFileLayout.html; the tests read the
// files back with OpenImageIO.
#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "output/file/atomic_file.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::image {

struct ExrPart {
    std::string name;  ///< empty: the only part, in a file without parts
    ExrSpec spec;
    /// Parts of the same run grow together. A later run begins when all parts of the earlier runs are complete.
    int run = 0;
};

/// Writes ZIP at zlib's level 1, without a date. The bytes depend only on the pixels, not on the order in which parts
/// are written. Memory holds the blocks of 16 lines that wait for their turn: the blocks of one band, if the parts of
/// a run are written side by side.
class ExrBook {
public:
    /// Opens `path` at once, like AtomicFile. All parts have the same size. Throws EnvironmentError. Throws
    /// std::logic_error for parts that no reader would accept: none, a name used twice, different sizes, no channels.
    ExrBook(const std::filesystem::path& path, std::vector<ExrPart> parts);
    ~ExrBook();
    ExrBook(const ExrBook&) = delete;
    ExrBook& operator=(const ExrBook&) = delete;

    /// Writes the next `rows` rows of a part, starting at row `y_begin`. `pixels` holds rows · width · channels samples
    /// of four bytes in native byte order. The channels of a pixel lie side by side, in the order of the spec.
    /// Different parts may be written concurrently. Throws EnvironmentError (a full disk), and std::logic_error for
    /// rows out of order or a wrong size.
    void write_rows(std::size_t part, int y_begin, int row_count, std::span<const std::byte> pixels);

    /// Gives the file its final name. Throws EnvironmentError, and std::logic_error if rows are missing.
    void close();

private:
    struct PartState;
    using BlockPosition = std::tuple<int, int, std::size_t>;  ///< run, block, part

    [[nodiscard]] bool has_parts() const;
    void write_header();
    void add_block(std::size_t part, int block, std::string bytes);
    void write_waiting_blocks();

    std::string path_;
    std::vector<PartState> part_states_;
    std::mutex mutex_;  ///< guards all members below it
    file::AtomicFile file_;
    std::map<BlockPosition, std::string> waiting_blocks_;
    std::vector<BlockPosition> order_;  ///< order in which blocks are written
    std::size_t next_in_order_ = 0;     ///< index in `order_` of the next block
    std::exception_ptr failure_;        ///< the first failure; the file is then lost, so later calls throw it again
};

}  // namespace lostbits::output::image
