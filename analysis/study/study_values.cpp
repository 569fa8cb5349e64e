#include "analysis/study/study_values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "analysis/study/studies.hpp"
#include "number/error.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::analysis::study {

StudyValues study_values(const std::vector<StudyOption>& options, const std::vector<std::string>& option_texts) {
    StudyValues values;
    for (const std::string& text : option_texts) {
        const std::size_t equals = std::min(text.find('='), text.size());
        const std::string name = text.substr(0, equals), value = text.substr(std::min(equals + 1, text.size()));
        const auto option = std::ranges::find(options, name, &StudyOption::name);
        if (option == options.end()) {
            std::vector<std::string> names;
            for (const StudyOption& known : options) names.push_back(known.name);
            throw InputError(fmt::format("option \"{}\" is unknown; {}", name, text::did_you_mean(name, names)));
        }
        if (!option->allowed_values.empty() &&
            std::ranges::find(option->allowed_values, value) == option->allowed_values.end())
            throw InputError(
                fmt::format("{} is \"{}\"; write one of {}", name, value, fmt::join(option->allowed_values, ", ")));
        values[name].push_back(value);
    }
    for (const StudyOption& option : options)
        if (values[option.name].empty()) values[option.name] = option.default_values;
    return values;
}

void fail_unknown_study(const std::string& name, const std::vector<std::string>& names) {
    throw InputError(fmt::format("study \"{}\" is unknown; {}", name, text::did_you_mean(name, names)));
}

}  // namespace lostbits::analysis::study
