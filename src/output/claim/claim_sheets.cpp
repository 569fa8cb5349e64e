#include "output/claim/claim_sheets.hpp"

#include <fmt/format.h>

#include "output/consistency/consistency_sheet.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::output::claim {

std::string picture_consistency(const std::filesystem::path& folder, const std::vector<measure::map::MapRow>& rows,
                                const std::string& name, const std::filesystem::path& data_dir) {
    const auto found = scene::file::find_scene(name, data_dir);
    const scene::file::Scene scene = scene::file::load_scene(found.path, {.variant = found.variant}).front();
    const measure::consistency::ConsistencyRequest request{
        .scene = &scene, .rows = rows, .checks = measure::consistency::checks_for(scene, rows)};
    const std::string file = scene.id + ".consistency.png";
    consistency::ConsistencySheet sheet(image::image_backend(), folder / "pictures" / file, request);
    sheet.finish(measure::consistency::run_consistency(request, &sheet));
    return fmt::format("![{}](pictures/{})\n", scene.title, file);
}

}  // namespace lostbits::output::claim
