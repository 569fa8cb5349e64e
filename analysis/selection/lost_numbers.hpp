// Says on stderr which numbers of a file the formats of the rows cannot hold: what rounds to 0 or to infinity.
#pragma once

#include <string>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "scene/file/scene.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::analysis::selection {

/// The constants of its march, where a row marches, and its lengths.
void note_lost_numbers(const scene::file::Scene& scene, const std::vector<measure::evaluate::TestedForm>& rows);

/// The same at every step of a sweep, whose rays are made for it: 4 s for 4000 steps of 1024 views.
void note_lost_numbers(const scene::sweep::SweepFile& sweep, const std::vector<measure::evaluate::TestedForm>& rows,
                       intersect::process::StopToken stop);

/// The lengths of all cases. Words such as `tiny` are numbers of every format and never lost.
void note_lost_numbers(const scene::sweep::CaseFile& file, const std::vector<measure::evaluate::TestedForm>& rows);

/// Says which assignments of `--set` change nothing: the constants of a march where no row marches.
void note_idle_settings(const std::vector<std::string>& set, const std::string& id,
                        const std::vector<measure::evaluate::TestedForm>& rows);

/// Both, of a scene that `set` has changed; nothing where `quiet`.
void note_numbers(const scene::file::Scene& scene, const std::vector<std::string>& set,
                  const std::vector<measure::evaluate::TestedForm>& rows, bool quiet);

}  // namespace lostbits::analysis::selection
