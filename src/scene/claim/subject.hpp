// What a claim is measured on: a struct for each kind, and its keys in a file.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "number/real.hpp"
#include "scene/file/appearance.hpp"

namespace lostbits::scene::claim {

/// The picture of a scene, one of its pixels alone, or one sample of a march along its pixel (0, 0).
struct SceneSubject {
    std::string name;
    std::optional<int> step = {};
    std::optional<std::pair<int, int>> pixel = {};  ///< column and row
};

struct SweepSubject {
    struct Along {};  ///< all of it, for an onset
    struct At {
        std::vector<double> values;  ///< one an axis
    };
    struct Case {
        std::string name;
    };
    /// Every float of a range: the sweep's own, or from `from` to `to`.
    struct EveryFloat {
        std::string ray;               ///< empty: its only one
        std::optional<Real> from, to;  ///< both or neither
    };

    std::string name;
    std::variant<Along, At, Case, EveryFloat> part = {};

    template <class Part>
    [[nodiscard]] const Part* part_if() const {
        return std::get_if<Part>(&part);
    }
};

/// The picture that `lostbits render` makes of a scene.
struct RenderSubject {
    std::string name;
    std::optional<file::Stage> stage = {};  ///< absent: the last that the scene asks for
};

/// The respawned rays of a scene, as of `lostbits offsets`: by which strategy, to which side, from which points.
struct OffsetsSubject {
    std::string name, strategy = {}, side = {}, points = {};
};

/// The questions about a scene that `lostbits consistency` puts in two ways.
struct ConsistencySubject {
    std::string name, check;
};

/// The worst ray that a sweep file with a `[search]` finds.
struct SearchSubject {
    std::string name;
};

/// What a form and format are wanted to keep on a scene.
struct WishedBits {
    double bits = 0, wrong = 0;
    std::string at;  ///< `p99`, `max`: of how many hits the bits are wanted
};

/// What `lostbits mend` makes of a form.
struct MendSubject {
    std::string name;  ///< of the scene
    WishedBits wish;
    std::optional<std::pair<int, int>> size = {};  ///< of the picture; absent: the scene's
};

/// A row of a table, which stands in the place of a form.
struct TableSubject {
    std::string name, row = {};
    double at = 0;  ///< its argument
};

/// Speed against speed: of a kernel over another's (`over_form` in `over_kernel`), or of all processors over one.
struct TimingSubject {
    std::string name, data = {};  ///< see measure/speed/timing_work.hpp
    std::string kernel = {}, over_form = {}, over_kernel = {};
    bool all_processors = false;
};

/// A form and format among others on the rays of a scene: by a wish, which it meets or not, or by its time over
/// another's.
struct ChoiceSubject {
    struct Others {
        WishedBits wish;
        std::vector<std::string> formats;  ///< of the other candidates
    };
    struct Over {
        std::string form, format;
    };

    std::string name;  ///< of the scene
    std::variant<Others, Over> against = {};
};

/// In the order in which they are measured.
using Subject = std::variant<SceneSubject, SweepSubject, RenderSubject, OffsetsSubject, ConsistencySubject,
                             SearchSubject, MendSubject, TableSubject, TimingSubject, ChoiceSubject>;

struct Claim;
/// `[claim.given]` of a claim whose profile is known: its subject, form and format. InputError with a position.
void read_given(toml::TableReader table, Claim& claim);

}  // namespace lostbits::scene::claim
