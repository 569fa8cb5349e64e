// The program as a shell sees it.
#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "scratch.hpp"

namespace lostbits::test {

/// True if the program was built with a sanitizer of addresses or threads. Those reserve terabytes before anything
/// runs, so that no limit of memory lets the program start, and take ten times as long.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool under_sanitizer = true;
#elif defined(__has_feature)
inline constexpr bool under_sanitizer = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool under_sanitizer = false;
#endif

struct Outcome {
    int code = 0;  ///< the exit status, or 128 + the signal
    std::string out, err;
};

/// Runs `lostbits ARGUMENTS` through a shell in `folder`; `before` goes in front of the program (`ulimit -f 8;`).
Outcome run(const std::string& arguments, const std::filesystem::path& folder = ".", const std::string& before = "");

/// The same, which succeeds.
Outcome must(const std::string& arguments, const std::filesystem::path& folder = ".", const std::string& before = "");

/// Arguments that are refused, a part of the message, and the exit status.
struct RefusedArguments {
    std::string words, says;
    int code = 2;
};
/// Runs `lostbits COMMAND WORDS` of each row in the folder: it prints nothing, and leaves nothing there.
void check_refused(const Scratch& folder, const std::string& command, const std::vector<RefusedArguments>& rows);

/// Shell words behind a command: a signal ends it after this many seconds of processor time. Wall time would end it
/// before it begins on a machine with other work.
std::string end_after(double seconds, const std::string& signal);

/// The option that puts results into a folder below the scratch folder, or into the scratch folder itself (`""`).
inline std::string into(const Scratch& scratch, const std::string& folder = "out") {
    return " -o '" + (folder.empty() ? scratch.path() : scratch.path() / folder).string() + "'";
}

/// From now on `run` uses the image module that ships, for a test that looks at pictures; otherwise it uses
/// tests/plain_images.cpp.
void draw_pictures();

/// True if a text contains another; a check that fails shows both.
class HasText {
public:
    HasText(const std::string& text, const std::string& part)
        : text_(text), part_(part), is_(text.find(part) != std::string::npos) {}
    operator bool() const { return is_; }
    friend std::ostream& operator<<(std::ostream& out, const HasText& has) {
        return out << '"' << has.part_ << "\" in\n" << has.text_.substr(0, 4000);
    }

private:
    const std::string &text_, &part_;
    bool is_;
};
inline HasText has(const std::string& text, const std::string& part) { return {text, part}; }

/// The commands that the program's help names.
std::set<std::string> commands();

/// The names of all files below a folder, relative to it, sorted.
std::vector<std::string> files_below(const std::filesystem::path& folder);

/// A CSV without quotes or line breaks inside its fields, row by row, by column name.
std::vector<std::map<std::string, std::string>> read_csv(const std::filesystem::path& file);

/// The number in a cell of a table; NaN for an empty one.
inline double number_in(const std::string& cell) {
    return cell.empty() ? std::nan("") : std::strtod(cell.c_str(), nullptr);
}

/// An axis of a sweep file, with its keys in that order.
struct AxisText {
    std::string name, set, from, to;
    int steps = 3;
    std::string spacing = "log2";
};
std::string make_axis(const AxisText& axis);
/// A sweep file with these tables.
std::string make_sweep_file(const std::string& tables);

/// A valid sweep of a ray distribution along one axis, for tests that change it or make it wrong.
extern const std::string small_sweep;
/// A valid sweep over a constant of a march.
extern const std::string march_sweep;
/// A claim of a file: the contents of `[claim.given]` and of `[claim.expect]`, and keys of its own.
struct ClaimText {
    std::string id, given, expect, more = {}, verdict = "\"holds\"", source = "-";
};
/// A file of such claims; `head` has the keys of the file.
std::string make_claim_file(const std::vector<ClaimText>& claims, const std::string& head = "");
/// Test and expected value of such a claim.
inline std::string form_keys(const std::string& form, const std::string& format = "f32") {
    return "form = \"" + form + "\"\nformat = \"" + format + "\"\n";
}
inline std::string metric_keys(const std::string& metric, const std::string& in = "[0, 1]") {
    return "metric = \"" + metric + "\"\nin = " + in + "\n";
}

/// A claim that is refused, its position, and a part of the message.
struct RefusedClaim {
    std::string given, expect, says, more = {}, verdict = "\"holds\"";
};
/// Runs `lostbits check` in the folder on each claim, as c.toml.
void check_refused_claims(const Scratch& folder, const std::vector<RefusedClaim>& rows, const std::string& head = "",
                          const std::string& options = "");

/// A file of one claim, about a scene `mine.toml` beside it.
extern const std::string one_claim;
/// The text of a scene with the tables `primitives`, seen by `camera`, which looks at the origin if it has no other
/// target. `head` is the text before the tables, such as the size.
std::string scene_text(const std::string& primitives, const std::string& head = "",
                       const std::string& camera = "kind = \"pinhole\"\nfov_deg = 30\neye = [0, 0, 5]\n");

/// A valid scene, for tests that make it wrong: a sphere of radius 1 five units in front of a 24x16 camera.
extern const std::string good_scene;
/// The same with the first occurrence of `what` replaced.
std::string spoil_scene(const std::string& what, const std::string& by);

/// A text with `by` in place of the first `what`, which must be there.
std::string replace_text(std::string text, const std::string& what, const std::string& by);

/// Number of occurrences of `part` in a text.
int count_in(const std::string& text, const std::string& part);

}  // namespace lostbits::test
