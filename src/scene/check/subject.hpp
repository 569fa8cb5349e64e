// Subject of a claim: a struct for each kind of subject, and the reader of their keys.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "number/real.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::check {

/// The picture of a scene, one of its pixels, or one sample of a march along its pixel (0, 0).
struct SceneSubject {
    std::string name;
    std::optional<int> step = {};
    std::optional<std::pair<int, int>> pixel = {};  ///< column and row
};

struct SweepSubject {
    struct WholeSweep {};  ///< for an onset
    struct SweepPosition {
        std::vector<double> values;  ///< one per axis
    };
    struct Case {
        std::string name;
    };
    /// Every float of a range: the sweep's own, or from `from` to `to`.
    struct EveryFloat {
        std::string ray;               ///< empty: the only ray
        std::optional<Real> from, to;  ///< both or neither
    };

    std::string name;
    std::variant<WholeSweep, SweepPosition, Case, EveryFloat> part = {};

    template <class Part>
    [[nodiscard]] const Part* part_if() const {
        return std::get_if<Part>(&part);
    }
};

/// A study of a scene, such as `lostbits offsets`. The claim is about the summary row whose columns have the values in
/// `where`, and the values of those options that are also columns.
struct StudySubject {
    std::string name;                                             ///< name of the scene
    std::string study;                                            ///< `offsets`
    std::map<std::string, std::string> options = {}, where = {};  ///< by option, by column of the summary
};

/// The worst ray found by a sweep file with a `[search]` table.
struct SearchSubject {
    std::string name;
};

/// Requirement on a form and format on a scene.
struct RequiredBits {
    double bits = 0, max_wrong_fraction = 0;
    std::string quantile;  ///< of the hits that must keep the bits: `p99`, `max`
};

/// The repair of a form, as by `lostbits mend`.
struct MendSubject {
    std::string name;  ///< name of the scene
    RequiredBits requirement;
    std::optional<std::pair<int, int>> size = {};  ///< size of the picture; absent: the scene's
};

/// A row of a table, in place of a form.
struct TableSubject {
    std::string name, row = {};
    double argument = 0;
};

/// A ratio of speeds: of one kernel to another (`baseline_form` in `baseline_kernel`), or of all processors to one.
struct TimingSubject {
    std::string name, data = {};  ///< see measure/trade/timing_work.hpp
    std::string kernel = {}, baseline_form = {}, baseline_kernel = {};
    bool uses_all_processors = false;
};

/// A form and format among others on the rays of a scene. They are judged by a requirement, which they meet or not, or
/// by their time relative to that of another form and format.
struct ChoiceSubject {
    struct OtherForms {
        RequiredBits requirement;
        std::vector<std::string> formats;  ///< formats of the other candidates
    };
    struct RelativeTime {
        std::string form, format;
    };

    std::string name;  ///< name of the scene
    std::variant<OtherForms, RelativeTime> against = {};
};

/// The kinds of subjects, in the order in which they are measured.
using Subject = std::variant<SceneSubject, SweepSubject, StudySubject, SearchSubject, MendSubject, TableSubject,
                             TimingSubject, ChoiceSubject>;

struct Claim;
/// Reads `[claim.given]` of a claim whose profile is known: its subject, form and format. Throws InputError with a
/// position.
void read_given(toml::TableReader table, Claim& claim);

}  // namespace lostbits::scene::check
