// Functions that share a file or a class with a reader, and need half of the program. None of them is called here.
#include <stdexcept>

#include "intersect/bounding_box/behind.hpp"
#include "intersect/bounding_box/box_methods.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/columns/columns.hpp"
#include "output/check/claim_files.hpp"
#include "output/file/result_folder.hpp"
#include "output/image/exr_parts.hpp"

namespace {
[[noreturn]] void unreached() { throw std::logic_error("a reader does more than reading"); }
}  // namespace

namespace lostbits::intersect {
namespace bounding_box {
const BoxMethod& default_box_method() { unreached(); }
const table::Intersector& boxed_form(const BoxMethod& /*way*/, const table::Intersector& /*box*/,
                                     const table::Intersector& /*form*/) {
    unreached();
}
}  // namespace bounding_box
namespace transform {
const table::Intersector& transformed_form(const TransformMethod& /*space*/, const table::Intersector& /*form*/) {
    unreached();
}
}  // namespace transform
}  // namespace lostbits::intersect

namespace lostbits::measure::columns {
void add_absolute_values(std::span<const double> /*values*/, RawAbsoluteSums& /*sizes*/) { unreached(); }
}  // namespace lostbits::measure::columns

namespace lostbits::output {
namespace file {
void note_result(const std::filesystem::path& /*path*/) { unreached(); }
bool is_in_own_folder(const std::filesystem::path& /*path*/) { unreached(); }
void require_own_result(const std::filesystem::path& /*path*/) { unreached(); }
}  // namespace file
namespace image {
std::pair<std::string, std::string> compiler_attribute() { unreached(); }
}  // namespace image
namespace claim {
std::string quantity_text(const scene::check::Claim& /*claim*/) { unreached(); }
}  // namespace claim
}  // namespace lostbits::output
