#include "fuzz/fuzz.hpp"
#include "scene/claim/claims_file.hpp"

namespace lostbits::fuzz {

void fuzz_claims(std::string_view bytes) {
    const std::filesystem::path path = file_of(bytes);
    answer_or_error([&] { static_cast<void>(scene::claim::read_claims(path)); });
}

}  // namespace lostbits::fuzz
