#include "measure/repair/price.hpp"

#include <fmt/format.h>

#include <cctype>
#include <deque>
#include <fstream>
#include <stdexcept>

#include "intersect/device/temporary_folder.hpp"
#include "intersect/external/plugin.hpp"
#include "intersect/process/child.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/repair/form_with_transform.hpp"
#include "number/error.hpp"

namespace lostbits::measure::repair {

namespace external = intersect::external;
namespace fs = std::filesystem;
namespace simd = intersect::simd;
using intersect::Target;
using intersect::table::HitBatch;
using intersect::table::Intersector;
using intersect::table::RayBatch;

namespace {

/// Kernels that a library exports for a form. They stay valid, since the library stays loaded until the program ends.
template <class F>
struct Kernels {
    KernelWithTransform<F> single, packs;
    simd::Isa isa;      ///< of the packs
    std::size_t lanes;  ///< in a register
};

/// Answers whole packs by the packed kernel, if the run has the register width that the kernel was compiled for, and
/// the remaining rays one by one.
template <class F>
void run_kernels(const Kernels<F>& kernels, ColumnsWithTransform<F> columns, std::size_t size) {
    const std::size_t packed_size =
        kernels.packs && simd::current_isa() == kernels.isa ? size / kernels.lanes * kernels.lanes : 0;
    columns.size = packed_size;
    if (packed_size != 0) kernels.packs(&columns);

    for (const F*& column : columns.ray) column += packed_size;
    if (columns.tmax) columns.tmax += packed_size;
    for (F*& column : columns.results) column += packed_size;
    columns.hit += packed_size;
    columns.size = size - packed_size;
    kernels.single(&columns);
}

template <class F>
void run_on_target(void* kernels, const RayBatch<F>& rays, const Target<F>& target, const HitBatch<F>& hits) {
    const bool has_one_primitive = target.primitives.size() == 1;
    const std::size_t rays_per_call = has_one_primitive ? rays.size() : 1;
    for (std::size_t i = 0; i < rays.size(); i += rays_per_call) {
        const Primitive<F>& primitive = target.primitives[has_one_primitive ? 0 : i];
        if (!primitive.transform)
            throw std::logic_error("a form that takes a matrix was given a primitive without one");
        run_kernels(*static_cast<const Kernels<F>*>(kernels),
                    {.ray = {&rays.ox[i], &rays.oy[i], &rays.oz[i], &rays.dx[i], &rays.dy[i], &rays.dz[i]},
                     .tmax = rays.tmax.empty() ? nullptr : &rays.tmax[i],
                     .primitive = primitive.numbers.data(),
                     .matrix = primitive.transform->matrix.data(),
                     .results = {&hits.t[i], &hits.near[i], &hits.far[i]},
                     .hit = &hits.hit[i],
                     .size = rays_per_call},
                    rays_per_call);
    }
}

template <class F>
intersect::table::Kernel<F> load_kernel(const external::Library& library, const std::string& name) {
    static std::deque<Kernels<F>> all_kernels;
    using Kernel = KernelWithTransform<F>;
    using external::find_symbol;
    const simd::Isa isa = simd::current_isa();
    const std::size_t bytes = isa == simd::Isa::w512 ? 64 : isa == simd::Isa::w256 ? 32 : 16;
    all_kernels.push_back({find_symbol<Kernel>(library, (name + "_alone").c_str()),
                           find_symbol<Kernel>(library, (name + "_packs").c_str()), isa, bytes / sizeof(F)});
    Kernels<F>& kernels = all_kernels.back();
    if (!kernels.single) throw std::logic_error(name + ": the compiled library does not export its kernel");
    return {run_on_target<F>, &kernels};
}

bool is_double(const RepairedSource& form) { return form.original.format.engine == Format::Engine::native64; }

/// True if the forms take the matrix of their primitive. All forms of a list do or none does, so the first form
/// decides.
bool have_transform_methods(const std::vector<RepairedSource>& forms) {
    return !forms.empty() && forms.front().original.form->has_transform_method;
}

/// Source text that includes `mended0.hpp`, `mended1.hpp`, … and exports the kernels of each form.
std::string make_source_with_transforms(const std::vector<RepairedSource>& forms) {
    std::string text = "#include \"measure/repair/form_with_transform.hpp\"\n";
    for (std::size_t k = 0; k < forms.size(); ++k) {
        std::string primitive(row_of(forms[k].original.form->shape).name);
        primitive.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(primitive.front())));
        text += fmt::format("#include \"mended{}.hpp\"\nLOSTBITS_PLACED_FORM(mended{}, {}, {}, {})\n", k, k,
                            forms[k].type, primitive, is_double(forms[k]) ? "double" : "float");
    }
    return text;
}

/// Makes a row for each form, in the format of the form that was repaired. These rows use the register width of the
/// run, as all rows with a transform do.
std::vector<external::Formula> formulas_with_transforms(const fs::path& library_path,
                                                        const std::vector<RepairedSource>& forms) {
    static std::deque<intersect::Info> infos;
    const external::Library loaded = external::load_library(library_path);
    std::vector<external::Formula> formulas;
    for (std::size_t k = 0; k < forms.size(); ++k) {
        const Intersector& original_form = *forms[k].original.form;
        const std::string name = "mended" + std::to_string(k);
        intersect::Info& info = infos.emplace_back(*original_form.info);
        info.name = external::never_freed_copy("mended." + name);
        Intersector form{.info = &info,
                         .shape = original_form.shape,
                         .native32 = nullptr,
                         .native64 = nullptr,
                         .has_transform_method = true};
        if (is_double(forms[k])) form.native64 = load_kernel<double>(loaded, name);
        else form.native32 = load_kernel<float>(loaded, name);
        formulas.push_back({.intersector = form, .packed = {}, .who = nullptr, .first_root_forms = {}});
    }
    return formulas;
}

void write_file(const fs::path& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    if (!(out << text).flush())
        throw EnvironmentError(file.string() + ": cannot write this file; set TMPDIR to a folder with free space");
}

/// Runs the compiler. Throws EnvironmentError with the compiler's output if it fails.
void run_compiler(const intersect::process::ProgramArguments& arguments, const RepairRequest& request) {
    intersect::process::ChildProcess child(
        arguments, {.who = arguments.front(), .timeout_advice = "", .seconds = 600, .stop = request.limit.stop});
    const auto result = child.read_to_end();
    if (result.status == 0) return;
    const std::string output = result.output.empty() ? "failed without any output" : result.output;
    throw EnvironmentError(intersect::process::shell_command(arguments) + ": " + output);
}

/// Loads a library that this program compiled. A failure is an EnvironmentError: its cause is the machine, not the
/// user's input.
template <class Load>
auto load_compiled(const fs::path& library, const Load& load) {
    try {
        return load(library);
    } catch (const InputError& error) {
        throw EnvironmentError(
            std::string(error.what()) +
            "; the folder may not allow programs to run (noexec), or memory may be short; set TMPDIR to another one");
    }
}

std::string make_library_source(const std::vector<RepairedSource>& forms) {
    if (have_transform_methods(forms)) return make_source_with_transforms(forms);
    std::string text = "#include <lostbits_form.hpp>\n", names;
    for (std::size_t k = 0; k < forms.size(); ++k) {
        text += "#include \"mended" + std::to_string(k) + ".hpp\"\n";
        names += (k == 0 ? "" : ", ") + forms[k].type;
    }
    return text + "LOSTBITS_FORMULAS(" + names + ")\n";
}

/// Writes the sources of the forms to a folder and compiles them. Returns the path of the library.
fs::path compile_library(const RepairRequest& request, const std::vector<RepairedSource>& forms,
                         const CompilerSetup& setup, const fs::path& folder) {
    const auto path = [&](const std::string& name) { return (folder / name).string(); };
    const auto flags_argument = [&](const std::string& name) { return "@" + (setup.flags / name).string(); };
    for (std::size_t k = 0; k < forms.size(); ++k)
        write_file(path("mended" + std::to_string(k) + ".hpp"), forms[k].header);
    const std::string source = path("mended.cpp"), packs = path("packs.o"), library = path("mended.so"),
                      isa_flags = "form.w" + std::string(name_of(simd::current_isa())) + ".flags";
    write_file(source, make_library_source(forms));

    // The packed kernels have an object file of their own, compiled for the register width of the run.
    intersect::process::ProgramArguments link{setup.compiler, "-shared", source};
    if (fs::exists(setup.flags / isa_flags)) {
        // form.flags names the libraries to link as well; `-c` does not use them.
        run_compiler(
            {setup.compiler, "-c", source, "-o", packs, flags_argument("form.flags"), flags_argument(isa_flags)},
            request);
        link.push_back(packs);
    }

    link.insert(link.end(), {"-o", library, flags_argument("form.flags")});
    run_compiler(link, request);
    return library;
}

/// Throws std::logic_error if a compiled form has other answers than its tape on the rays of the request.
void require_answers_of_tape(const RepairRequest& request, const RepairedSource& source, const Intersector& compiled) {
    RepairRequest form_request = request;
    form_request.tested_form = source.original;
    QualityMeasurer measurer(form_request);
    const evaluate::TestedForm compiled_row{
        .form = &compiled, .format = source.original.format, .touching = source.original.touching};
    if (!has_answers_of_tape(compiled_row, *source.tape, form_request, measurer))
        throw std::logic_error(source.type + ": the compiled form has other answers than its tape");
}

/// Returns the work with scalar arithmetic. Rows with a transform use the current register width, so the width is
/// `scalar` while they run.
trade::TimedWork in_scalar_arithmetic(trade::TimedWork work) {
    work.pass = [pass = std::move(work.pass)] {
        const simd::Isa previous_isa = simd::current_isa();
        set_isa(simd::Isa::scalar);
        pass();
        set_isa(previous_isa);
    };
    return work;
}

}  // namespace

std::vector<intersect::external::Formula> compile_and_load(const RepairRequest& request,
                                                           const std::vector<RepairedSource>& forms,
                                                           const CompilerSetup& setup) {
    if (!fs::exists(setup.flags / "form.flags"))
        throw EnvironmentError((setup.flags / "form.flags").string() +
                               ": this file is missing; it holds the compiler flags for forms; a build of lostbits has "
                               "it, and an installation has it in lib/lostbits");
    const intersect::device::TemporaryFolder folder("lostbits-mend");
    const fs::path library = compile_library(request, forms, setup, folder.path);
    auto formulas =
        have_transform_methods(forms)
            ? load_compiled(library, [&](const fs::path& file) { return formulas_with_transforms(file, forms); })
            : load_compiled(library, external::load_formulas);

    for (std::size_t k = 0; k < forms.size(); ++k) {
        require_answers_of_tape(request, forms[k], formulas[k].intersector);
        if (!formulas[k].intersector.has_transform_method)
            simd::register_packs({{formulas[k].intersector.info, formulas[k].packed}});
    }
    return formulas;
}

std::vector<Price> measure_prices(const RepairRequest& request, const std::vector<evaluate::TestedForm>& tested_forms,
                                  const trade::TimingPlan& plan) {
    auto work_on_rays = request.scene ? trade::SceneWork(*request.scene, request.limit)
                                      : trade::SceneWork(request.rays->sample, request.limit);
    const simd::Isa isa = simd::current_isa();
    std::vector<trade::TimedWork> work;
    std::vector<Price> prices;
    for (const evaluate::TestedForm& tested_form : tested_forms) {
        const bool uses_packs = tested_form.form->has_transform_method || is_packed(*tested_form.form, isa);
        prices.push_back({.isa = name_of(uses_packs ? isa : simd::Isa::scalar)});
        work.push_back(work_on_rays.work_for(tested_form, packed_kernels(*tested_form.form, isa)));
        work.push_back(work_on_rays.work_for(tested_form, packed_kernels(*tested_form.form, simd::Isa::scalar)));
        if (tested_form.form->has_transform_method) work.back() = in_scalar_arithmetic(work.back());
    }

    const auto times = time_interleaved(work, plan);
    for (std::size_t k = 0; k < tested_forms.size(); ++k) {
        prices[k].packed = times[2 * k];
        prices[k].single = times[2 * k + 1];
    }
    return prices;
}

}  // namespace lostbits::measure::repair
