// A choice in words, what meets the wish, what it costs and assumes, and how far it holds; and its files: choose.csv
// (every form and format, cheapest first), room.csv, offset.csv, inputs.csv, requirement.csv, requirement.png,
// front.png, choose.txt and datapackage.json. Times are measured and differ from run to run; the columns of accuracy do
// not.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "measure/choice/candidates.hpp"
#include "measure/choice/obstacle.hpp"
#include "measure/choice/requirement.hpp"
#include "measure/choice/room.hpp"
#include "output/speed/trade_files.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::choice {

/// A candidate that a form was mended to (`lostbits mend`), since the form does not meet the wish.
struct MendedCandidate {
    std::string name;              ///< as the candidate's form is called
    std::string how;               ///< `sphere.half_b, 3 of its 20 operations in double: c, disc`
    measure::choice::Worth apart;  ///< on rays of the scene on which nothing was searched
    std::string file;              ///< that holds it as C++
};

/// All that is known of a choice.
struct Chosen {
    const measure::choice::ChoiceRequest& request;
    const std::vector<measure::choice::Candidate>& all;
    measure::choice::TimedRays timed;
    std::optional<std::size_t> meets;                              ///< the cheapest that meets the wish
    std::vector<measure::choice::Room> rooms = {};                 ///< of that one
    std::optional<measure::choice::SafeOffsets> offsets = {};      ///< of that one, where it was measured
    std::optional<measure::choice::Obstacle> obstacle = {};        ///< where nothing meets the wish
    std::optional<measure::choice::Requirement> requirement = {};  ///< of each pixel of a scene
    std::optional<std::vector<MendedCandidate>> mended = {};       ///< where they were asked for

    /// Null for a candidate that is a form as it is.
    [[nodiscard]] const MendedCandidate* mended_as(std::string_view form) const {
        if (!mended) return nullptr;
        const auto found = std::ranges::find(*mended, form, &MendedCandidate::name);
        return found == mended->end() ? nullptr : &*found;
    }
};

/// Bits to one decimal, or to as many as show on which side of the wish they are: 15.96 beside a wish of 16.
std::string bits_beside(double kept, const measure::choice::Wish& wish);
/// `, 0.0012 off`, with as many digits as tell it from the wish's tolerance; empty where there is none.
std::string off_beside(double off, const measure::choice::Wish& wish);

/// `16 bits of 99 of 100 hits, no wrong decision`.
std::string in_words(const measure::choice::Wish& wish);
/// The answer, several lines; every time is of this run.
std::string in_words(const Chosen& chosen);
/// What formats the pixels need, and the least that switching between forms could cost; two or three lines.
std::string in_words(const Chosen& chosen, const measure::choice::Requirement& requirement);
/// What stands in the way, in lines with two blanks in front; `near` comes nearest to the wish.
std::string obstacle_in_words(const Chosen& chosen, const measure::choice::Candidate& near);
/// `; beyond that no ray hits anything`: why a room ends there. `broken` is said where the wish fails.
std::string end_in_words(const measure::choice::Room& room, const measure::choice::FileRays* rays,
                         const std::string& broken);
/// `binary32`, `binary64`, `p31`: a format of inputs.
std::string name_of_inputs(const FloatFormat& format);

/// Every form and format by time and bits kept, with the Pareto front and what is chosen.
void write_front_plot(const std::filesystem::path& path, const Chosen& chosen);

/// A row of choose.csv: a candidate, or the answers of the files.
struct CandidateRow {
    speed::KernelName name;
    const measure::speed::Timing* time;  ///< null: it is not known
    const measure::choice::Worth* worth;
    bool meets, chosen;
    const MendedCandidate* mended;  ///< null: it is a form as it is
};
table::Table<CandidateRow> candidate_table();
/// Cheapest first.
std::vector<CandidateRow> candidate_rows(const Chosen& chosen);

/// rays, true_hits, wrong, wrong_fraction and kept_bits.
table::Table<measure::choice::Worth> worth_columns();

/// The columns of room.csv.
table::Table<measure::choice::Room> room_table();

/// A strategy that is safe to one side or to both.
struct SafeOffsetRow {
    std::string_view side;
    measure::offset::SafeStrategy safe;
};

/// A choice of inputs that come wider.
struct InputRow {
    const measure::choice::Obstacle* obstacle;
    const measure::choice::InputTrial* trial;
};

struct RequirementRow {
    std::string_view form, format;
    file::Cell time_ns;
    std::uint64_t met, required, pixels;
};
table::Table<RequirementRow> requirement_table();
/// A row per form and format with a pixel to its name or a time, cheapest first; then one per format under `any`, and
/// one for the pixels on which nothing meets the wish.
std::vector<RequirementRow> requirement_rows(const Chosen& chosen, const measure::choice::Requirement& requirement);
/// Left the cheapest that meets the wish, right the narrowest format in which any form does; pixel by pixel.
void draw_requirement(const std::filesystem::path& path, const Chosen& chosen,
                      const measure::choice::Requirement& requirement);

/// Opened before the work, named when it is whole.
class ChoiceFiles {
public:
    explicit ChoiceFiles(const std::filesystem::path& folder);
    void finish(const Chosen& chosen);
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
    table::TableFile<CandidateRow> candidates_;
    table::TableFile<measure::choice::Room> rooms_;
    table::TableFile<SafeOffsetRow> offsets_;
    table::TableFile<InputRow> inputs_;
    table::TableFile<RequirementRow> requirement_;
};

}  // namespace lostbits::output::choice
