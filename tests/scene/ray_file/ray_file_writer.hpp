// Files of rays for tests: the same columns of numbers in every container.
#pragma once

#include <algorithm>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "output/file/number_text.hpp"
#include "scene/ray_file/ray_file.hpp"
#include "scene/scene_text.hpp"

namespace lostbits::scene::test {

/// Columns of one length, each with a name.
struct Columns {
    std::vector<std::string> names;
    std::vector<std::vector<double>> numbers;  ///< a column each

    void add(const std::string& name, std::vector<double> column) {
        names.push_back(name);
        numbers.push_back(std::move(column));
    }
    [[nodiscard]] std::size_t rows() const { return numbers.front().size(); }
    [[nodiscard]] std::string joined_names(const std::string& behind = "") const {
        std::string all;
        for (const std::string& name : names) all += (all.empty() ? "" : ",") + name + behind;
        return all;
    }
};

template <class Text>
std::string to_csv(const Columns& columns, const Text& text) {
    std::ostringstream out;
    out << columns.joined_names() << '\n';
    for (std::size_t i = 0; i < columns.rows(); ++i) {
        for (std::size_t c = 0; c < columns.names.size(); ++c) out << (c > 0 ? "," : "") << text(columns.numbers[c][i]);
        out << '\n';
    }
    return out.str();
}

template <class F>
void append(std::string& bytes, double number, bool big_endian) {
    const F stored = static_cast<F>(number);
    char raw[sizeof(F)];
    std::memcpy(raw, &stored, sizeof(F));
    if (big_endian) std::reverse(raw, raw + sizeof(F));
    bytes.append(raw, sizeof(F));
}

enum class ArrayOrder { rows, columns };

template <class F>
std::string to_bytes(const Columns& columns, bool big_endian = false, ArrayOrder order = ArrayOrder::rows) {
    std::string bytes;
    const std::size_t n = columns.rows(), k = columns.names.size();
    for (std::size_t i = 0; i < n * k; ++i) {
        const bool rows = order == ArrayOrder::rows;
        append<F>(bytes, columns.numbers[rows ? i % k : i / n][rows ? i / k : i % n], big_endian);
    }
    return bytes;
}

/// An array of numpy, version 1, with this dictionary in front of the numbers.
inline std::string to_npy(const std::string& dictionary, const std::string& numbers) {
    std::string header = dictionary;
    while ((10 + header.size() + 1) % 64 != 0) header += ' ';
    header += '\n';
    const auto size = header.size();
    return std::string("\x93NUMPY\x01", 7) + '\0' + static_cast<char>(size & 255) + static_cast<char>(size >> 8) +
           header + numbers;
}

template <class F>
std::string to_npy(const Columns& columns, bool big_endian = false, ArrayOrder order = ArrayOrder::rows) {
    const std::string type = std::string(big_endian ? ">" : "<") + (sizeof(F) == 4 ? "f4" : "f8");
    return to_npy("{'descr': '" + type + "', 'fortran_order': " + (order == ArrayOrder::rows ? "False" : "True") +
                      ", 'shape': (" + std::to_string(columns.rows()) + ", " + std::to_string(columns.names.size()) +
                      "), }",
                  to_bytes<F>(columns, big_endian, order));
}

using ScratchRayFile = lostbits::test::ScratchFile;

/// All records of a file, read so many at a time.
inline std::vector<ray_file::Chunk> read_all(ray_file::RayFile& ray_file, std::size_t most = 1000) {
    std::vector<ray_file::Chunk> chunks;
    for (ray_file::Records records; ray_file.next(most, records);) chunks.push_back(ray_file.decode(records));
    return chunks;
}

/// Message of the error from opening or reading a file; empty if no error is thrown.
inline std::string fault_of(const std::string& name, const std::string& bytes,
                            const ray_file::ReadOptions& options = {}) {
    const ScratchRayFile file(name, bytes);
    try {
        const auto opened = ray_file::open_ray_file(file.path(), options);
        static_cast<void>(read_all(*opened));
    } catch (const InputError& error) {
        const std::string what = error.what(), folder = file.path().parent_path().string() + "/";
        return what.starts_with(folder) ? what.substr(folder.size()) : what;
    }
    return "";
}

}  // namespace lostbits::scene::test
