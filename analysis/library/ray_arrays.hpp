// Reads rays from arrays in the memory of the caller, in place: the arrays are never copied as a whole.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analysis/library/lostbits.h"
#include "scene/ray_file/ray_file.hpp"

namespace lostbits::analysis::library {

/// A column with one number per ray: number i is at `data + i*stride` bytes. With a stride of 0 all rays have the same
/// number.
struct ArrayColumn {
    std::string name;  ///< as in files of rays: ox, dz, t, hit, cx
    const std::byte* data = nullptr;
    std::ptrdiff_t stride = 0;
    enum class Type { f32, f64, boolean } type = Type::f64;
};

/// Appends one column for each of the names from an array of the caller. Appends nothing if the array is not given.
void append_columns(std::vector<ArrayColumn>& target, const lostbits_array& array, std::span<const std::string> names);
/// Throws InputError if an array with that many rows and columns spans more bytes than any memory has. Otherwise the
/// offset of every item fits in a ptrdiff_t.
void require_addressable(const lostbits_array& array, std::size_t row_count, std::size_t column_count,
                         const char* name);
OpenEnds parse_open_ends(const std::string& text);

/// Number i of a column, rounded once to the format.
double number_at(const ArrayColumn& column, std::size_t i, const Format& format);

/// The columns of `count` rays. The arrays must live longer than the ray file. A column whose name means nothing in a
/// file of rays is kept as text. An error in a ray is an InputError that begins with `name` and the index of the ray,
/// from 0.
class RayArrays final : public scene::ray_file::RayFile {
public:
    /// Uses the members format, primitive, open and stop of `options`. If no format is given, answers have the format
    /// of t or, without t, the format of the widest column.
    RayArrays(const std::string& name, std::vector<ArrayColumn> columns, std::size_t count,
              const scene::ray_file::ReadOptions& options);

    [[nodiscard]] const scene::ray_file::Layout& layout() const override { return layout_; }
    [[nodiscard]] std::optional<std::uint64_t> size() const override { return count_; }
    [[nodiscard]] std::uint64_t bytes() const override { return 0; }
    bool next(std::size_t max_records, scene::ray_file::Records& records) override;
    [[nodiscard]] scene::ray_file::Chunk decode(const scene::ray_file::Records& records) const override;

private:
    std::vector<ArrayColumn> columns_;
    std::size_t count_, read_ = 0;
    scene::ray_file::Layout layout_;
    intersect::process::StopToken stop_;
};

}  // namespace lostbits::analysis::library
