// Rays that lie in the memory of whoever asks: read where they are, never copied whole.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/dump/dump.hpp"

namespace lostbits::analysis::library {

/// Numbers, one a ray: number i is at `data + i·step` bytes, of a step of 0 the same for all rays.
struct ArrayColumn {
    std::string name;  ///< as files of rays have it: ox, dz, t, hit, cx
    const std::byte* data = nullptr;
    std::ptrdiff_t step = 0;
    enum class Type { f32, f64, boolean } type = Type::f64;
};

/// Number i of a column, rounded once to the format.
double number_at(const ArrayColumn& column, std::size_t i, const Format& format);

/// The columns of `count` rays, which outlive the dump; one of no name that files know is kept. What is wrong with a
/// ray is an InputError that begins with `name` and its place from 0.
class ArrayDump final : public scene::dump::Dump {
public:
    /// `options` as of a file, of which format, solid, open and stop are read. Without a format answers are of that of
    /// t, else of the widest of all columns.
    ArrayDump(const std::string& name, std::vector<ArrayColumn> columns, std::size_t count,
              const scene::dump::DumpOptions& options);

    [[nodiscard]] const scene::dump::Layout& layout() const override { return layout_; }
    [[nodiscard]] std::optional<std::uint64_t> size() const override { return count_; }
    [[nodiscard]] std::uint64_t bytes() const override { return 0; }
    bool next(std::size_t most, scene::dump::Records& records) override;
    [[nodiscard]] scene::dump::Chunk decode(const scene::dump::Records& records) const override;

private:
    std::vector<ArrayColumn> columns_;
    std::size_t count_, read_ = 0;
    scene::dump::Layout layout_;
    intersect::process::StopToken stop_;
};

}  // namespace lostbits::analysis::library
