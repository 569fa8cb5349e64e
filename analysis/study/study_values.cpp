#include "analysis/study/study_values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "analysis/study/studies.hpp"
#include "number/error.hpp"
#include "scene/toml/did_you_mean.hpp"

namespace lostbits::analysis::study {

StudyValues study_values(const std::vector<StudyOption>& options, const std::vector<std::string>& given) {
    StudyValues values;
    for (const std::string& each : given) {
        const std::size_t equals = std::min(each.find('='), each.size());
        const std::string name = each.substr(0, equals), word = each.substr(std::min(equals + 1, each.size()));
        const auto option = std::ranges::find(options, name, &StudyOption::name);
        if (option == options.end()) {
            std::vector<std::string> names;
            for (const StudyOption& known : options) names.push_back(known.name);
            throw InputError(fmt::format("option \"{}\" is unknown; {}", name, scene::toml::did_you_mean(name, names)));
        }
        if (!option->known.empty() && std::ranges::find(option->known, word) == option->known.end())
            throw InputError(fmt::format("{} is \"{}\"; write one of {}", name, word, fmt::join(option->known, ", ")));
        values[name].push_back(word);
    }
    for (const StudyOption& option : options)
        if (values[option.name].empty()) values[option.name] = option.usual;
    return values;
}

void refuse_study(const std::string& name, const std::vector<std::string>& names) {
    throw InputError(fmt::format("study \"{}\" is unknown; {}", name, scene::toml::did_you_mean(name, names)));
}

}  // namespace lostbits::analysis::study
