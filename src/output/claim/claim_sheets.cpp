#include "output/claim/claim_sheets.hpp"

#include <fmt/format.h>

#include "output/consistency/consistency_files.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::output::claim {

scene::file::Scene shown_scene(const std::string& name, const measure::claim::ClaimRequest& run) {
    const auto found = scene::file::find_scene(name, run.data_dir);
    return std::move(scene::file::load_scene(found.path, {.variant = found.variant, .stop = run.stop}).front());
}

std::string picture_consistency(const std::filesystem::path& folder,
                                const std::vector<measure::evaluate::TestedForm>& rows, const std::string& name,
                                const measure::claim::ClaimRequest& run) {
    const scene::file::Scene scene = shown_scene(name, run);
    const measure::consistency::ConsistencyRequest request{.scene = &scene,
                                                           .rows = rows,
                                                           .checks = measure::consistency::checks_for(scene, rows),
                                                           .limit = {.stop = run.stop}};
    const std::string file = scene.id + ".consistency.png";
    consistency::ConsistencyPictures sheet(request, folder / "pictures" / file);
    sheet.finish(measure::consistency::run_consistency(request, &sheet));
    return fmt::format("![{}](pictures/{})\n", scene.title, file);
}

std::string screenshots_in(const std::filesystem::path& folder) {
    std::string text;
    for (const auto& [name, what] : {std::pair{"maps", "Lost bits of one form beside another, and one ray"},
                                     std::pair{"operations", "Culprits, and the operations of one ray"},
                                     std::pair{"sweeps", "Lost bits along a parameter"},
                                     std::pair{"claims", "Claims; each leads to its pixels or its plot"}}) {
        const std::string file = fmt::format("screenshots/{}.png", name);
        if (std::filesystem::exists(folder / file)) text += fmt::format("\n![{}]({})\n", what, file);
    }
    return text.empty() ? "" : "\nIt looks like this:\n" + text;
}

}  // namespace lostbits::output::claim
