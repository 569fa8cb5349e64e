#include "measure/mend/price.hpp"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "intersect/device/temporary_folder.hpp"
#include "intersect/process/child.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/mend/placed_rows.hpp"
#include "number/error.hpp"

namespace lostbits::measure::mend {

namespace fs = std::filesystem;
namespace simd = intersect::simd;

namespace {

/// A folder while the compiler works.
class Bench {
public:
    Bench() : folder(intersect::device::make_temporary_folder("lostbits-mend")) {}
    ~Bench() {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }
    Bench(const Bench&) = delete;
    Bench& operator=(const Bench&) = delete;

    void write(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }
    [[nodiscard]] std::string read(const std::string& name) const {
        std::ifstream in(folder / name);
        return {std::istreambuf_iterator<char>(in), {}};
    }

    const fs::path folder;
};

std::string quoted(const fs::path& path) {
    std::string text = "'";
    for (const char c : path.string()) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

void run_compiler(const Bench& bench, const std::string& command, const MendRequest& request) {
    intersect::process::Child child("cd " + quoted(bench.folder) + " && (" + command + ") >said 2>&1; echo $?",
                                    {.who = "the compiler", .duty = "", .seconds = 600, .stop = request.limit.stop});
    if (child.read_line() == "0") return;
    throw EnvironmentError(command + ": " + bench.read("said"));
}

std::string source_of(const std::vector<Written>& forms) {
    if (are_placed(forms)) return placed_source_of(forms);
    std::string text = "#include <lostbits_form.hpp>\n", names;
    for (std::size_t k = 0; k < forms.size(); ++k) {
        text += "#include \"mended" + std::to_string(k) + ".hpp\"\n";
        names += (k == 0 ? "" : ", ") + forms[k].type;
    }
    return text + "LOSTBITS_FORMULAS(" + names + ")\n";
}

/// Rows through the space of a solid take the registers of the run: work that finds none.
speed::TimedWork alone(speed::TimedWork work) {
    work.pass = [pass = std::move(work.pass)] {
        const simd::Isa before = simd::current_isa();
        set_isa(simd::Isa::scalar);
        pass();
        set_isa(before);
    };
    return work;
}

}  // namespace

std::vector<intersect::doors::Formula> compiled(const MendRequest& request, const std::vector<Written>& forms,
                                                const Workshop& workshop) {
    if (!fs::exists(workshop.flags / "form.flags"))
        throw EnvironmentError((workshop.flags / "form.flags").string() +
                               ": not there, and so nobody knows how forms are compiled for this program; a build of "
                               "lostbits has it, and an installed one in lib/lostbits");
    const Bench bench;
    for (std::size_t k = 0; k < forms.size(); ++k) bench.write("mended" + std::to_string(k) + ".hpp", forms[k].header);
    bench.write("mended.cpp", source_of(forms));
    const auto flags = [&](const std::string& name) { return " @" + quoted(workshop.flags / name); };
    const std::string isa = "form.w" + std::string(name_of(simd::current_isa())) + ".flags";
    std::string packs;
    if (fs::exists(workshop.flags / isa)) {
        // What is linked stands in the same file, and is not used yet.
        run_compiler(bench, workshop.compiler + " -c mended.cpp -o packs.o" + flags("form.flags") + flags(isa),
                     request);
        packs = " packs.o";
    }
    run_compiler(bench, workshop.compiler + " -shared mended.cpp" + packs + " -o mended.so" + flags("form.flags"),
                 request);
    const fs::path library = bench.folder / "mended.so";
    auto formulas = are_placed(forms) ? placed_rows(library, forms) : intersect::doors::load_formulas(library);
    for (std::size_t k = 0; k < forms.size(); ++k) {
        const evaluate::TestedForm& from = forms[k].from;
        MendRequest asked = request;
        asked.row = from;
        Judge judge(asked);
        const evaluate::TestedForm own{.form = &formulas[k].row, .format = from.format, .judged = from.judged};
        if (!answers_as(own, *forms[k].tape, asked, judge))
            throw std::logic_error(forms[k].type + ": compiled it has other answers than its tape");
        if (!own.form->is_placed) simd::enroll_packs({{formulas[k].row.info, formulas[k].packed}});
    }
    return formulas;
}

std::vector<Price> prices_of(const MendRequest& request, const std::vector<evaluate::TestedForm>& rows,
                             const speed::TimingPlan& plan) {
    auto on_rays = request.scene ? speed::SceneWork(*request.scene, request.limit)
                                 : speed::SceneWork(request.rays->sample, request.limit);
    const simd::Isa isa = simd::current_isa();
    std::vector<speed::TimedWork> work;
    std::vector<Price> prices;
    for (const evaluate::TestedForm& row : rows) {
        const bool in_packs = row.form->is_placed || is_packed(*row.form, isa);
        prices.push_back({.isa = name_of(in_packs ? isa : simd::Isa::scalar)});
        work.push_back(on_rays.on(row, packed_kernels(*row.form, isa)));
        work.push_back(on_rays.on(row, packed_kernels(*row.form, simd::Isa::scalar)));
        if (row.form->is_placed) work.back() = alone(work.back());
    }
    const auto times = time_interleaved(work, plan);
    for (std::size_t k = 0; k < rows.size(); ++k) prices[k].packed = times[2 * k], prices[k].single = times[2 * k + 1];
    return prices;
}

}  // namespace lostbits::measure::mend
