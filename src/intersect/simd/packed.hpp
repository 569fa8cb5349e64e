// The forms over SIMD packs, compiled for each register width; the width is chosen at run time among those that the
// processor has. The answers have the same bits as those of the scalar rows (any NaN counts as equal); only the speed
// differs.
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

/// Width of the registers: one ray at a time, or as many rays as a register of 128, 256 or 512 bits holds.
enum class Isa { scalar, w128, w256, w512 };

inline constexpr std::array<std::string_view, 4> isa_names{"scalar", "128", "256", "512"};

/// Bytes of a register.
constexpr std::size_t bytes_of(Isa isa) { return isa == Isa::w512 ? 64 : isa == Isa::w256 ? 32 : 16; }

inline constexpr std::string_view name_of(Isa isa) { return isa_names[static_cast<std::size_t>(isa)]; }
/// Returns the width with that name; empty for a name that is not in `isa_names`.
std::optional<Isa> find_isa(std::string_view name);

/// Widths that this build contains and this processor runs, narrowest first: `scalar` and `w128` everywhere; `w256`
/// needs AVX2 and FMA, `w512` also AVX-512 F, DQ and VL and BMI2.
std::vector<Isa> available_isas();
/// The widest of the available widths.
Isa best_isa();

/// Sets the width of `packed_kernels` for every thread; until then the width is `best_isa()`. Throws EnvironmentError,
/// without a change, for a width that is not available.
void set_isa(Isa isa);
Isa current_isa();

/// The kernels of a form; null in a format in which the form does not exist (see `Info::formats`). Batches have any
/// size. Kernels do not read or write beyond the spans.
struct PackedFormKernels {
    const Info* info;
    decltype(table::Intersector::native32) f32;
    decltype(table::Intersector::native64) f64;
};

/// The rows of all forms, in the order of `catalogue()`; for `scalar`, the rows of the table themselves. Empty if `isa`
/// is not available: such a kernel would execute an illegal instruction.
std::span<const PackedFormKernels> all_packed_kernels(Isa isa);

/// Returns the kernels of a row of the table, at an available width or at `current_isa()`. A row that is not compiled
/// for packs (a form that a test makes, an external function) keeps its own native kernels.
PackedFormKernels packed_kernels(const table::Intersector& form, Isa isa);
PackedFormKernels packed_kernels(const table::Intersector& form);
/// True if the row is compiled for packs at that width.
bool is_packed(const table::Intersector& form, Isa isa);

/// Kernels of a row outside the catalogue over packs of 128, 256 and 512 bits; null if not compiled.
struct ExternalPacks {
    const Info* info;
    std::array<RawFormKernels, 3> widths;
};
/// Adds the packs of external rows. Call it before any kernel is requested.
void register_packs(const std::vector<ExternalPacks>& rows);

/// Calls `use.operator()<S>(kernel)` with the kernel of a form in a format; the batches of the kernel are stored in S.
/// `native` holds the form's kernels in float and double: packed kernels, or the form's own.
template <class Use>
void with_kernel(const table::Intersector& form, const PackedFormKernels& native, const Format& format,
                 const Use& use) {
    with_number(format, [&]<class T>() {
        if constexpr (std::same_as<T, float>) use.template operator()<float>(native.f32);
        else if constexpr (std::same_as<T, double>) use.template operator()<double>(native.f64);
        else use.template operator()<double>([&](const auto&... a) { form.rounded(format.parameters, a...); });
    });
}

}  // namespace lostbits::intersect::simd
