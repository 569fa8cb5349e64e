// An EXR file of one part, or of several that grow side by side.
//
// OpenImageIO writes one part after the other, so that all but the first would have to wait on disk, uncompressed: 1.7
// GB for 41 rows of a map of 1024 × 1024. The file format asks for no such order.
//
// OpenEXR's own library, tried at 3.1.5, keeps to no order in Imf::MultiPartOutputFile, and its files have the size of
// ours to the byte. But a call of OutputPart::writePixels holds the lock of the whole file while it compresses: two
// threads take as long as one, and blocks lie in the file in the order of the calls, other bytes in each run. In a
// fixed order, rows would wait uncompressed for their turn, and be compressed by a pool of the library's own beside
// ours. The C interface takes blocks that are compressed already, but of one part after the other
// (EXR_ERR_INCORRECT_PART). Here each thread compresses its own rows and no lock is held meanwhile.
//
// The parts of scan lines are as https://openexr.com/en/latest/OpenEXRFileLayout.html has them; the tests read them
// back with OpenImageIO.
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
    std::string name;  ///< empty: the file has this one alone, and is none of parts
    ExrSpec spec;
    /// Parts of one run grow together; a later run begins when the parts of the ones before are whole.
    int run = 0;
};

/// ZIP at zlib's level 1, no date. The bytes depend on the pixels alone, not on which part is served first. Memory
/// holds the blocks of 16 lines that wait for their turn: those of one band where the parts of a run are served in
/// step.
class ExrBook {
public:
    /// Opens `path` at once, as AtomicFile does. All parts have the same size. Throws EnvironmentError, and
    /// std::logic_error for parts that no reader would take: none, a name used twice, other sizes, no channels.
    ExrBook(const std::filesystem::path& path, std::vector<ExrPart> parts);
    ~ExrBook();
    ExrBook(const ExrBook&) = delete;
    ExrBook& operator=(const ExrBook&) = delete;

    /// The next `rows` rows of a part, the first of which is `y_begin`. `pixels` holds rows · width · channels samples
    /// of four bytes in native byte order, the channels of a pixel side by side in the order of the spec. Different
    /// parts may be served at the same time. Throws EnvironmentError (a full disk), and std::logic_error for rows out
    /// of order or a wrong size.
    void write_rows(std::size_t part, int y_begin, int rows, std::span<const std::byte> pixels);

    /// Gives the file its final name. Throws EnvironmentError, and std::logic_error when rows are lacking.
    void close();

private:
    struct Page;
    using Place = std::tuple<int, int, std::size_t>;  ///< run, block, part

    [[nodiscard]] bool has_parts() const;
    void write_header();
    void add_block(std::size_t part, int block, std::string bytes);
    void write_waiting();

    std::string path_;
    std::vector<Page> pages_;
    std::mutex mutex_;  ///< of all below
    file::AtomicFile out_;
    std::map<Place, std::string> waiting_;
    std::vector<Place> order_;    ///< in which blocks are written
    std::size_t next_ = 0;        ///< in that order
    std::exception_ptr failure_;  ///< the first, which later calls repeat: the file is gone with it
};

}  // namespace lostbits::output::image
