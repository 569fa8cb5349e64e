#include "scene/sweep/convention.hpp"

#include <utility>

namespace lostbits::scene::sweep {

using intersect::convention_name;
using intersect::Touching;

namespace {

constexpr std::pair<std::string_view, Touching> words[] = {{convention_name(Touching::hit), Touching::hit},
                                                           {convention_name(Touching::miss), Touching::miss}};

}  // namespace

std::optional<Touching> convention_named(std::string_view word) {
    for (const auto& [name, touching] : words) {
        if (name == word) return touching;
    }
    return std::nullopt;
}

std::optional<Touching> read_convention(toml::TableReader& table) {
    return table.optional_one_of<Touching>("convention", words);
}

}  // namespace lostbits::scene::sweep
