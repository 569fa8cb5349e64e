// What mended forms cost: compiled by the user's compiler, held against their tapes, and timed. Nothing is estimated.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "intersect/doors/formulas.hpp"
#include "measure/mend/judge.hpp"

namespace lostbits::measure::mend {

/// Who compiles, and the folder with `form.flags` and `form.w256.flags`, as the build of this program left it.
struct Workshop {
    std::string compiler;
    std::filesystem::path flags;
};

/// A mended form as C++.
struct Written {
    const Tape* tape;
    std::string header;         ///< text
    std::string type;           ///< the struct's name, with its namespace
    evaluate::TestedForm from;  ///< the form that it was made of
};

/// Seconds a ray and solid.
struct Price {
    std::string_view isa = {};  ///< of the registers of `packed`; `scalar` where there is none
    speed::Timing packed{}, single{};
};

/// Compiles all of them into one library of forms, in packs of the current width too, and loads it; it stays loaded.
/// Of the request the scene and the limit count. EnvironmentError with what the compiler said; std::logic_error where a
/// compiled form has other bits than its tape on any ray of the scene.
std::vector<intersect::doors::Formula> compiled(const MendRequest& request, const std::vector<Written>& forms,
                                                const Workshop& workshop);

/// All rows in one run, on rays of the scene, as `lostbits trade --scene` times them.
std::vector<Price> prices_of(const MendRequest& request, const std::vector<evaluate::TestedForm>& rows,
                             const speed::TimingPlan& plan);

}  // namespace lostbits::measure::mend
