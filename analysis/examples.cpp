#include <algorithm>

#include "commands.hpp"

namespace lostbits::analysis {

namespace {

struct CommandExamples {
    const char* command;
    std::vector<shell::Example> examples;
};

/// Two examples of each command that is not a study; studies bring their own. A test runs each of them in a folder
/// where `before` and `after` hold maps of one scene, `parts` holds the only shard of a run, and `mine.so` is a
/// library.
const CommandExamples all_examples[] = {
    {"check",
     {{"lostbits check --filter 'float.*'", "Measures the claims whose id begins with `float`"},
      {"lostbits check data/claims/arithmetic.toml --measure", "Shows what each claim of a file measures now"}}},
    {"choose",
     {{"lostbits choose near-benign --bits 16 -i 'sphere.h*' --size 32x32 --quick",
       "Finds the cheapest of some forms that keeps 16 bits of t on a scene"},
      {"lostbits choose data/dumps/far-sphere.csv --answer-format f32 --sphere 0,0,0,1 --bits 6 -i 'sphere.h*' --quick",
       "Finds the cheapest form for the rays of a file"}}},
    {"devices",
     {{"lostbits devices", "Lists the drivers that can run a shader here"},
      {"lostbits devices --json", "Writes the same for a program"}}},
    {"diff",
     {{"lostbits diff before after", "Compares the maps in two folders"},
      {"lostbits diff before after --allow 'lost_bits*=0.5' --ignore 'fault_*'",
       "Lets some columns differ by half a bit, and leaves out others"}}},
    {"explain",
     {{"lostbits explain near-benign --worst -i sphere.press", "Explains the worst ray of a scene for a form"},
      {"lostbits explain --sphere 0,0,5,1 --ray 0,0,0,0,0.19,1 -i sphere.unified -f f64",
       "Explains a ray and a sphere of your own, in double"}}},
    {"judge",
     {{"lostbits judge data/dumps/far-sphere.csv --answer-format f32 --sphere 0,0,0,1",
       "Compares the answers in a file with the truth"},
      {"lostbits judge data/dumps/far-sphere.csv --answer-format f32 --sphere 0,0,0,1 -i sphere.unified --rows",
       "Judges a form on the same rays too, and writes a row per ray"}}},
    {"list",
     {{"lostbits list forms", "Lists every form with its shape and its source"},
      {"lostbits list metrics --json", "Writes the metrics for a program"}}},
    {"map",
     {{"lostbits map near-benign -i sphere.press -f f32", "Draws the bits that one form loses in float"},
      {"lostbits map near-benign -i 'sphere.h*' --metric ulp_error --set 'sphere[0].radius=2' --size 64x64",
       "Draws another metric of several forms, with another radius"}}},
    {"mend",
     {{"lostbits mend rtg-fig-7-3-4100-oblique -i sphere.schoolbook --bits 16 --size 16x16",
       "Finds which operations to compute wider so that every hit keeps 16 bits"},
      {"lostbits mend rtg-fig-7-3-4100-oblique -i sphere.schoolbook --bits 16 --size 16x16 --emit mended.hpp",
       "Writes the changed form as a C++ header too"}}},
    {"merge",
     {{"lostbits merge parts", "Joins the shards of a run that lie in a folder"},
      {"lostbits merge parts -o -", "Prints the table of the whole run"}}},
    {"plugin",
     {{"lostbits plugin check mine.so", "Checks every form of a library"},
      {"lostbits plugin check --pipe 'python3 examples/pipes/schoolbook.py'", "Checks a program behind a pipe"}}},
    {"report",
     {{"lostbits report near-benign --no-claims -i sphere.press -f f32 --size 32x32",
       "Makes a page about one form on one scene"},
      {"lostbits report near-benign box-one --no-claims -i sphere.press,box.signs -f f32 --size 32x32",
       "Makes a page about two scenes"}}},
    {"sweep",
     {{"lostbits sweep sphere-distance -i sphere.unified -f f32 --steps 8 --seeds 0",
       "Measures a form at 8 distances of a sphere, with one random set of rays"},
      {"lostbits sweep worst/near --worst -i sphere.press -f f32 --set starts=2,generations=4",
       "Searches ranges of numbers for the worst ray"}}},
    {"trade",
     {{"lostbits trade near-benign -i sphere.press -f f32 --size 32x32 --quick", "Times a form on the rays of a scene"},
      {"lostbits trade --shape box -i box.signs -f f32 --quick", "Times a form on rays of known kinds at a box"}}},
    {"completion",
     {{"lostbits completion bash > lostbits.bash", "Writes a script that bash can source"},
      {"lostbits completion fish > lostbits.fish", "Writes one for fish"}}},
    {"manual",
     {{"lostbits manual > lostbits.1", "Writes the manual page into a file"},
      {"lostbits manual | man -l -", "Shows the manual page"}}},
};

}  // namespace

void add_examples(const shell::Command& program) {
    for (const shell::Command& command : program.subcommands()) {
        const auto* const row = std::ranges::find(all_examples, command.name(), &CommandExamples::command);
        if (row != std::end(all_examples)) command.set_examples(row->examples);
    }
}

}  // namespace lostbits::analysis
