#include "fuzz/fuzz.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/edge_search_file.hpp"
#include "scene/sweep/exhaustive_file.hpp"
#include "scene/sweep/search_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::fuzz {

void fuzz_sweep(std::string_view bytes) {
    using scene::sweep::SweepKind;
    const std::filesystem::path path = file_of(bytes);
    answer_or_error([&] {
        switch (scene::sweep::sweep_kind(path)) {
            case SweepKind::axes: {
                const scene::sweep::SweepFile file(path, LOSTBITS_DATA_DIR);
                static_cast<void>(file.shapes());
                return;
            }
            case SweepKind::cases: {
                const scene::sweep::CaseFile file(path);
                return;
            }
            case SweepKind::search: {
                const scene::sweep::SearchFile file(path);
                return;
            }
            case SweepKind::edge_search: {
                const scene::sweep::EdgeSearchFile file(path, LOSTBITS_DATA_DIR);
                return;
            }
            case SweepKind::every_float: {
                const scene::sweep::ExhaustiveFile file(path, LOSTBITS_DATA_DIR);
                if (file.floats() > 0)
                    static_cast<void>(file.group_at(0, scene::sweep::float_at(file.ranges().front().first)));
                return;
            }
        }
    });
}

}  // namespace lostbits::fuzz
