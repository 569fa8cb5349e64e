#include "measure/mend/placed_rows.hpp"

#include <fmt/format.h>

#include <cctype>
#include <deque>
#include <stdexcept>

#include "intersect/doors/plugin.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/mend/placed_form.hpp"

namespace lostbits::measure::mend {

namespace doors = intersect::doors;
namespace simd = intersect::simd;
using intersect::Target;
using intersect::table::HitBatch;
using intersect::table::Intersector;
using intersect::table::RayBatch;

namespace {

/// What a library exports of a form, which is there as long as the library is loaded: to the end.
template <class F>
struct Kernels {
    PlacedKernel<F> alone, packs;
    simd::Isa isa;      ///< of the packs
    std::size_t lanes;  ///< in a register
};

/// Whole packs, where the run has the registers that they were compiled for, and the rest alone.
template <class F>
void answer(const Kernels<F>& kernels, PlacedColumns<F> columns, std::size_t size) {
    const std::size_t whole =
        kernels.packs && simd::current_isa() == kernels.isa ? size / kernels.lanes * kernels.lanes : 0;
    columns.size = whole;
    if (whole != 0) kernels.packs(&columns);
    for (const F*& column : columns.ray) column += whole;
    if (columns.tmax) columns.tmax += whole;
    for (F*& column : columns.told) column += whole;
    columns.hit += whole;
    columns.size = size - whole;
    kernels.alone(&columns);
}

template <class F>
void run(void* own, const RayBatch<F>& rays, const Target<F>& target, const HitBatch<F>& hits) {
    const bool one = target.solids.size() == 1;
    const std::size_t each = one ? rays.size() : 1;
    for (std::size_t i = 0; i < rays.size(); i += each) {
        const Solid<F>& solid = target.solids[one ? 0 : i];
        if (!solid.placed) throw std::logic_error("a form that takes a matrix is asked about a solid without one");
        answer(*static_cast<const Kernels<F>*>(own),
               {.ray = {&rays.ox[i], &rays.oy[i], &rays.oz[i], &rays.dx[i], &rays.dy[i], &rays.dz[i]},
                .tmax = rays.tmax.empty() ? nullptr : &rays.tmax[i],
                .solid = solid.numbers.data(),
                .matrix = solid.placed->matrix.data(),
                .told = {&hits.t[i], &hits.near[i], &hits.far[i]},
                .hit = &hits.hit[i],
                .size = each},
               each);
    }
}

template <class F>
intersect::table::Kernel<F> kernel_of(const doors::Library& library, const std::string& name) {
    static std::deque<Kernels<F>> all;
    using Kernel = PlacedKernel<F>;
    using doors::entry_of;
    const simd::Isa isa = simd::current_isa();
    const std::size_t bytes = isa == simd::Isa::w512 ? 64 : isa == simd::Isa::w256 ? 32 : 16;
    all.push_back({entry_of<Kernel>(library, (name + "_alone").c_str()),
                   entry_of<Kernel>(library, (name + "_packs").c_str()), isa, bytes / sizeof(F)});
    Kernels<F>& kernels = all.back();
    if (!kernels.alone) throw std::logic_error(name + ": compiled it is not there");
    return {run<F>, &kernels};
}

bool is_double(const Written& form) { return form.from.format.engine == Format::Engine::native64; }

}  // namespace

bool are_placed(const std::vector<Written>& forms) { return !forms.empty() && forms.front().from.form->is_placed; }

std::string placed_source_of(const std::vector<Written>& forms) {
    std::string text = "#include \"measure/mend/placed_form.hpp\"\n";
    for (std::size_t k = 0; k < forms.size(); ++k) {
        std::string solid(row_of(forms[k].from.form->shape).name);
        solid.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(solid.front())));
        text += fmt::format("#include \"mended{}.hpp\"\nLOSTBITS_PLACED_FORM(mended{}, {}, {}, {})\n", k, k,
                            forms[k].type, solid, is_double(forms[k]) ? "double" : "float");
    }
    return text;
}

std::vector<doors::Formula> placed_rows(const std::filesystem::path& library, const std::vector<Written>& forms) {
    static std::deque<intersect::Info> infos;
    const doors::Library loaded = doors::load_library(library);
    std::vector<doors::Formula> formulas;
    for (std::size_t k = 0; k < forms.size(); ++k) {
        const Intersector& like = *forms[k].from.form;
        const std::string name = "mended" + std::to_string(k);
        intersect::Info& info = infos.emplace_back(*like.info);
        info.name = doors::lasting_text("mended." + name);
        Intersector row{
            .info = &info, .shape = like.shape, .native32 = nullptr, .native64 = nullptr, .is_placed = true};
        if (is_double(forms[k])) row.native64 = kernel_of<double>(loaded, name);
        else row.native32 = kernel_of<float>(loaded, name);
        formulas.push_back({.row = row, .packed = {}, .who = nullptr, .first = {}});
    }
    return formulas;
}

}  // namespace lostbits::measure::mend
