// Kernels of OpenCL and CUDA behind a pipe: examples/pipes, on the available OpenCL device and on a stand-in for CUDA.
#include <initializer_list>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"
#include "counts.hpp"

namespace test_kernels {

using namespace lostbits::test;

namespace {

const std::string kernel = std::string(LOSTBITS_SOURCE_DIR) + "/examples/pipes/sphere.cl";

/// A pipe to the kernel, with a name and options for its compiler.
std::string opencl(const std::string& name, const std::string& options) {
    return " --pipe '" LOSTBITS_OPENCL_SPHERE " " + kernel + " " + name + " " + options + "'";
}

/// The first batch waits for the compiler of kernels: seconds, or many more on a busy machine.
const std::string patient = " --time-limit 300";

/// Setting that keeps the compiled kernels in the folder of the test, not in that of the user.
std::string kept_in(const Scratch& folder) { return "POCL_CACHE_DIR='" + (folder.path() / "kernels").string() + "' "; }

}  // namespace

TEST_CASE("kernels: OpenCL has the bits of C++ without contraction, and those of fused sums otherwise", "[kernels]") {
    const std::string rounded = " -cl-fp32-correctly-rounded-divide-sqrt";
    std::vector<std::string> scenes{"rtg-fig-7-3-4100-oblique"};
    if (is_long()) scenes.insert(scenes.end(), {"near-benign", "camera-inside"});
    for (const std::string& scene : scenes) {
        const Scratch folder;
        must("map " + scene + " --size 96x64 -i 'opencl.*' -i sphere.half_b -f f32 --pixels csv -o out" + patient +
                 opencl("opencl.as_written", "-DAS_WRITTEN" + rounded) + opencl("opencl.default", rounded) +
                 opencl("opencl.mad", rounded + " -cl-mad-enable") + opencl("opencl.fast", "-cl-fast-relaxed-math"),
             folder.path(), kept_in(folder));
        const auto out = folder.path() / "out" / scene;
        const auto bits = [&out](const std::string& form) { return contents(out / (form + ".f32.csv")); };
        const std::string ours = bits("sphere.half_b");
        CHECK(ours.size() > 100'000);
        CHECK(ours == bits("opencl.as_written"));
        const std::string device = contents(out / "datapackage.json");
        CHECK(has(device, "OpenCL"));
        // PoCL fuses on processors with fma; another device may have nothing to fuse with.
        if (!has(device, "PoCL")) continue;
        CHECK(ours != bits("opencl.default"));
        CHECK(bits("opencl.default") == bits("opencl.mad"));
        CHECK(ours != bits("opencl.fast"));
    }
}

TEST_CASE("kernels: OpenCL kernels keep their contracts", "[kernels]") {
    const Scratch folder;
    const Outcome o = must("plugin check" + patient + opencl("opencl.sphere", ""), folder.path(), kept_in(folder));
    CHECK(has(o.out, "keeps its contract"));
}

TEST_CASE("kernels: a kernel that cannot run is refused with a reason, and nothing is written", "[kernels]") {
    const Scratch kernels;
    const std::string wrong = kernels.write("wrong.cl", "__kernel void intersect() { nope(); }\n");
    const std::string other = kernels.write("other.cl", "__kernel void other() {}\n");
    const std::string program = " --pipe '" LOSTBITS_OPENCL_SPHERE;
    struct Fault {
        std::string before, pipe, says;
        int code;
    };
    for (const Fault& fault : std::initializer_list<Fault>{
             {"OCL_ICD_VENDORS=/nonexistent ", program + " " + kernel + "'", "no OpenCL device was found", 3},
             {"", program + " " + wrong + "'", "does not compile, see above", 2},
             {"", program + " " + other + "'", "has no kernel `intersect`", 2},
             {"", program + " no-such-file.cl'", "no-such-file.cl: cannot be read, or is empty", 2},
             {"", program + "'", "usage: opencl_sphere FILE.cl", 2},
             {"NO_CARD=1 ", " --pipe " LOSTBITS_CUDA_STAND_IN, "no CUDA card was found", 3},
             {"NO_MEMORY=1 ", " --pipe " LOSTBITS_CUDA_STAND_IN, "CUDA cannot allocate memory: out of memory", 3}}) {
        const Scratch folder;
        const Outcome o = run("map near-benign --size 32x24 -f f32 -o out" + patient + fault.pipe, folder.path(),
                              kept_in(kernels) + fault.before);
        INFO(fault.pipe << ": " << o.err);
        CHECK(o.code == fault.code);
        CHECK(has(o.err, fault.says));
        CHECK(folder.files().empty());
    }
}

TEST_CASE("kernels: the CUDA program and its kernel have the bits of C++ on a stand-in", "[kernels]") {
    for (const std::string scene : {"near-benign", "camera-inside"}) {
        const Scratch folder;
        must("map " + scene +
                 " --size 96x64 -i 'cuda.*' -i sphere.half_b -f f32 --pixels csv -o out --pipe " LOSTBITS_CUDA_STAND_IN,
             folder.path());
        const auto out = folder.path() / "out" / scene;
        CHECK(contents(out / "sphere.half_b.f32.csv") == contents(out / "cuda.sphere.f32.csv"));
    }
}

}  // namespace test_kernels
