// The forms over SIMD packs, compiled for each register width and chosen at run time by what the processor has. Their
// answers are the bits of the scalar rows (a NaN is a NaN); only the speed differs.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "intersect/simd/packed_raw.hpp"
#include "intersect/table/table.hpp"
#include "number/with_number.hpp"

namespace lostbits::intersect::simd {

/// Number of rays at a time: one, or as many as a register of 128, 256 or 512 bits holds.
enum class Isa { scalar, w128, w256, w512 };

inline constexpr std::array<std::string_view, 4> isa_names{"scalar", "128", "256", "512"};

inline constexpr std::string_view name_of(Isa isa) { return isa_names[static_cast<std::size_t>(isa)]; }
/// Nothing for a name that is not in `isa_names`.
std::optional<Isa> isa_named(std::string_view name);

/// Widths that this build contains and this processor runs, narrowest first: `scalar` and `w128` everywhere; `w256`
/// needs AVX2 and FMA, `w512` also AVX-512 F, DQ and VL and BMI2.
std::vector<Isa> available_isas();
/// The widest of them.
Isa best_isa();

/// Sets the width of `packed_kernels` for every thread; `best_isa()` until then. EnvironmentError for a width that is
/// not available; nothing changes then.
void set_isa(Isa isa);
Isa current_isa();

/// A form's kernels; null in a format in which the form does not exist (see `Info::formats`). Batches have any size;
/// nothing is read or written beyond the spans.
struct PackedRow {
    const Info* info;
    decltype(table::Intersector::native32) f32;
    decltype(table::Intersector::native64) f64;
};

/// Every form, in the order of `catalogue()`; for `scalar`, the rows of the table themselves. Empty if `isa` is not
/// available: calling such a kernel would be an illegal instruction.
std::span<const PackedRow> packed_rows(Isa isa);

/// The kernels of a row of the table, at an available width or at `current_isa()`. A row that is not compiled for packs
/// (a form that a test makes, an external function) has its own native kernels.
PackedRow packed_kernels(const table::Intersector& form, Isa isa);
PackedRow packed_kernels(const table::Intersector& form);
/// True if the row is compiled for packs at that width.
bool is_packed(const table::Intersector& form, Isa isa);

/// Kernels of a row outside the catalogue over packs of 128, 256 and 512 bits; null if not compiled.
struct OwnPacks {
    const Info* info;
    std::array<RawRow, 3> widths;
};
/// Adds the packs of rows that `table::enroll` adds. Call it before any kernel is asked for.
void register_packs(const std::vector<OwnPacks>& rows);

/// Calls `use.operator()<S>(kernel)` with the kernel of a form in a format; its batches are stored in S. `native` has
/// the form's kernels in float and double: packed ones, or its own.
template <class Use>
void with_kernel(const table::Intersector& form, const PackedRow& native, const Format& format, const Use& use) {
    with_number(format, [&]<class T>() {
        if constexpr (std::same_as<T, float>) use.template operator()<float>(native.f32);
        else if constexpr (std::same_as<T, double>) use.template operator()<double>(native.f64);
        else use.template operator()<double>([&](const auto&... a) { form.rounded(format.parameters, a...); });
    });
}

}  // namespace lostbits::intersect::simd
