// One fuzzer of libFuzzer: LOSTBITS_FUZZ_TARGET is the function of its target.
#include <cstddef>
#include <cstdint>

#include "fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    lostbits::fuzz::LOSTBITS_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
    return 0;
}
