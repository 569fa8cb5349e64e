#include "fuzz/fuzz.hpp"
#include "scene/claim/report_file.hpp"

namespace lostbits::fuzz {

void fuzz_report(std::string_view bytes) {
    const std::filesystem::path path = file_of(bytes);
    answer_or_error([&] { static_cast<void>(scene::claim::read_report_file(path)); });
}

}  // namespace lostbits::fuzz
