// Cost of repaired forms: each form is compiled by the user's compiler, compared with its tape, and timed. No cost is
// estimated.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "intersect/external/formulas.hpp"
#include "measure/repair/quality.hpp"

namespace lostbits::measure::repair {

/// Compiler, and the folder in which the build of this program wrote `form.flags` and `form.w256.flags`.
struct CompilerSetup {
    std::string compiler;
    std::filesystem::path flags;
};

/// Repaired form as C++.
struct RepairedSource {
    const Tape* tape;
    std::string header;             ///< text of the header
    std::string type;               ///< the struct's name, with its namespace
    evaluate::TestedForm original;  ///< the form that was repaired
};

/// Time in seconds for one ray and one primitive.
struct Price {
    std::string_view isa = {};  ///< instruction set of `packed`; `scalar` if the form is not timed in packs
    trade::Timing packed{}, single{};
};

/// Compiles all forms into one library, also for packs of the current width, and loads it. The library stays loaded.
/// Only the scene and the limit of the request are used. Throws EnvironmentError with the compiler's output if the
/// compiler fails, and std::logic_error if a compiled form gives other bits than its tape for any ray of the scene.
std::vector<intersect::external::Formula> compile_and_load(const RepairRequest& request,
                                                           const std::vector<RepairedSource>& forms,
                                                           const CompilerSetup& setup);

/// Times all forms in one run, on rays of the scene, as `lostbits trade SCENE` does.
std::vector<Price> measure_prices(const RepairRequest& request, const std::vector<evaluate::TestedForm>& tested_forms,
                                  const trade::TimingPlan& plan);

}  // namespace lostbits::measure::repair
