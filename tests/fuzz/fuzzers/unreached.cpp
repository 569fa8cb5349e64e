// What lies in one file with a reader, or in one class, and needs half of the program: nothing of it is called here.
#include <stdexcept>

#include "intersect/hull/behind.hpp"
#include "intersect/hull/hulls.hpp"
#include "intersect/space/spaced.hpp"
#include "measure/columns/columns.hpp"
#include "output/claim/claim_files.hpp"
#include "output/file/result_folder.hpp"
#include "output/image/exr_parts.hpp"

namespace {
[[noreturn]] void unreached() { throw std::logic_error("a reader does more than reading"); }
}  // namespace

namespace lostbits::intersect {
namespace hull {
const HullWay& usual_hull() { unreached(); }
const table::Intersector& behind(const HullWay& /*way*/, const table::Intersector& /*box*/,
                                 const table::Intersector& /*form*/) {
    unreached();
}
}  // namespace hull
namespace space {
const table::Intersector& through(const Space& /*space*/, const table::Intersector& /*form*/) { unreached(); }
}  // namespace space
}  // namespace lostbits::intersect

namespace lostbits::measure::columns {
void add_sizes(std::span<const double> /*values*/, RawSizes& /*sizes*/) { unreached(); }
}  // namespace lostbits::measure::columns

namespace lostbits::output {
namespace file {
void note_result(const std::filesystem::path& /*path*/) { unreached(); }
bool is_in_own_folder(const std::filesystem::path& /*path*/) { unreached(); }
void require_own(const std::filesystem::path& /*path*/) { unreached(); }
}  // namespace file
namespace image {
std::pair<std::string, std::string> compiler_attribute() { unreached(); }
}  // namespace image
namespace claim {
std::string quantity(const scene::claim::Claim& /*claim*/) { unreached(); }
}  // namespace claim
}  // namespace lostbits::output
