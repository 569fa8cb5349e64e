// The fuzzer of libFuzzer: $LOSTBITS_FUZZ_TARGET names its target; without it, the names of all targets are written.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "fuzz/fuzz.hpp"

namespace {
lostbits::fuzz::Fuzz* chosen_fuzz = nullptr;
}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    const char* const name = std::getenv("LOSTBITS_FUZZ_TARGET");
    for (const auto& target : lostbits::fuzz::targets) {
        if (name == nullptr) std::puts(std::string(target.name).c_str());
        else if (target.name == name) chosen_fuzz = target.run;
    }
    if (chosen_fuzz == nullptr) std::exit(name == nullptr ? 0 : 2);
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    chosen_fuzz({reinterpret_cast<const char*>(data), size});
    return 0;
}
