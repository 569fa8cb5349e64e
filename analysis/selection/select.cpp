#include "analysis/selection/select.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "analysis/selection/options.hpp"
#include "measure/answer/against.hpp"
#include "number/error.hpp"
#include "scene/rays/composed_forms.hpp"
#include "shapes/number_names.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::analysis::selection {

using intersect::table::Intersector;
using measure::evaluate::TestedForm;
using measure::metric::Metric;

namespace {

bool compares_forms(const Metric* m) { return m->domain == measure::metric::MetricDomain::pairs; }

/// Names that other programs have for the formats.
constexpr std::pair<std::string_view, const char*> formats_elsewhere[] = {
    {"float", "f32"},    {"single", "f32"},    {"float32", "f32"},  {"binary32", "f32"},
    {"double", "f64"},   {"float64", "f64"},   {"binary64", "f64"}, {"half", "fp16"},
    {"float16", "fp16"}, {"binary16", "fp16"}, {"bfloat16", "bf16"}};

/// Advice for an unknown name. If no name is near, it lists the names with the same first part: those of box forms for
/// `box.slab`.
std::string name_advice(const std::string& name, const std::vector<std::string>& names) {
    constexpr std::string_view function_prefix = "function.";
    if (name.starts_with(function_prefix) &&
        std::ranges::none_of(names, [&](const std::string& known) { return known.starts_with(function_prefix); }))
        return "forms with this prefix come from --function FILE:NAME, which is missing";
    if (text::closest(name, names)) return text::did_you_mean(name, names);
    const std::size_t dot = name.find('.');
    std::vector<std::string> names_of_group;
    if (dot != std::string::npos)
        std::ranges::copy_if(names, std::back_inserter(names_of_group),
                             [&](const std::string& known) { return known.starts_with(name.substr(0, dot + 1)); });
    return text::did_you_mean(name, names_of_group.empty() ? names : names_of_group);
}

[[noreturn]] void fail_unknown_format(const std::string& name, const char* option) {
    if (name.size() > 1 && name.front() == 'p' && name.find_first_not_of("0123456789", 1) == std::string::npos)
        throw InputError(fmt::format("{} {}: unknown format; in pN, N is the number of significand bits, from 2 to 53",
                                     option, name));
    std::vector<std::string> names{"f32", "f64", "fp16", "bf16", "tf32"};
    const auto elsewhere = std::ranges::find(formats_elsewhere, name, &std::pair<std::string_view, const char*>::first);
    std::string hint;
    if (elsewhere != std::end(formats_elsewhere)) {
        std::erase(names, elsewhere->second);
        hint = fmt::format("use \"{}\" for {}; other formats: {}, pN (N from 2 to 53), pA..pB", elsewhere->second, name,
                           fmt::join(names, ", "));
    } else hint = text::did_you_mean(name, names) + " (or pN with N from 2 to 53, or a range p5..p12)";
    throw InputError(fmt::format("{} {}: unknown format; {}", option, name, hint));
}

}  // namespace

bool is_pattern(const std::string& text) { return text.find_first_of("*?[") != std::string::npos; }

std::vector<std::size_t> find_indices(const std::vector<std::string>& patterns, const std::vector<std::string>& names,
                                      const std::string& noun, const char* option) {
    std::vector<bool> chosen(names.size());
    for (const std::string& pattern : patterns) {
        bool is_matched = false;
        for (std::size_t i = 0; i < names.size(); ++i) {
            // The names of strategies differ in their last part, so that part alone is enough.
            if (matches_any({pattern}, names[i]) || (noun == "strategy" && names[i].ends_with("." + pattern)))
                chosen[i] = is_matched = true;
        }
        if (is_matched) continue;

        // The message names the list of `lostbits list` with all names.
        const std::string last_word = noun.substr(noun.rfind(' ') + 1);
        const std::string list_name = last_word == "strategy" ? "strategies"
                                      : last_word == "box"    ? "boxes"
                                                              : last_word + "s";
        if (is_pattern(pattern))
            throw NothingSelected(fmt::format("{} {}: no {} matches this pattern; `lostbits list {}` lists all", option,
                                              pattern, noun, list_name));
        throw InputError(fmt::format("{} {}: unknown {}; {} (`lostbits list {}` lists all)", option, pattern, noun,
                                     name_advice(pattern, names), list_name));
    }

    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (chosen[i]) indices.push_back(i);
    return indices;
}

std::vector<const Intersector*> select_forms(const std::vector<std::string>& patterns, const char* option) {
    std::vector<std::string> form_patterns;
    std::vector<const Intersector*> forms, composed_forms;
    for (const std::string& pattern : patterns) {
        const bool is_set = names_set(pattern);
        if (!is_set && !scene::rays::split_composed_name(pattern)) {
            form_patterns.push_back(pattern);
            continue;
        }
        for (const Intersector* const set : is_set ? select_sets(pattern, option) : select_composed(pattern, option))
            append_if_missing(composed_forms, set);
    }
    forms = select_items(intersect::table::intersectors(), form_patterns, "form", option);
    forms.insert(forms.end(), composed_forms.begin(), composed_forms.end());
    return forms;
}

namespace {

/// Adds the metrics of a pattern such as `step:*`, which is about the steps of a transform.
void add_steps(const std::string& pattern, measure::metric::MetricSet& metric_set, std::vector<const Metric*>& chosen) {
    bool is_matched = false;
    for (const std::string_view step : intersect::transform::step_names) {
        const std::string name = "step:" + std::string(step);
        if (!matches_any({pattern}, name)) continue;
        is_matched = true;
        append_if_missing(chosen, metric_set.find(name));
    }
    if (!is_matched)
        throw NothingSelected(fmt::format("--metric {}: no step matches this pattern; the steps are {}", pattern,
                                          fmt::join(intersect::transform::step_names, ", ")));
}

/// Throws InputError for a metric whose step or operation is missing.
void require_complete_metric(const std::string& pattern) {
    if (pattern == "step:")
        throw InputError(
            fmt::format("--metric step:: the step is missing; write step:NAME, such as step:origin; the steps are {}",
                        fmt::join(intersect::transform::step_names, ", ")));
    if (pattern == "contribution" || pattern.ends_with(':')) {
        const std::string kind = pattern.substr(0, pattern.find(':'));
        throw InputError(
            fmt::format("--metric {}: the operation is missing; write {}:LABEL, such as {}:c; `lostbits list labels` "
                        "shows the labels of every form",
                        pattern, kind, kind));
    }
}

}  // namespace

std::vector<const Metric*> select_metrics(const std::vector<std::string>& patterns,
                                          measure::metric::MetricSet& metric_set) {
    std::vector<const Metric*> chosen;
    for (const std::string& pattern : patterns) {
        if (pattern.starts_with("step:") && is_pattern(pattern)) {
            add_steps(pattern, metric_set, chosen);
        } else if (const Metric* const metric = metric_set.find(pattern)) {
            append_if_missing(chosen, metric);
        } else {
            require_complete_metric(pattern);
            for (const Metric* m : select_items(measure::metric::metrics(), {pattern}, "metric", "--metric"))
                append_if_missing(chosen, m);
        }
    }
    return chosen;
}

namespace {

bool compares_any(const std::vector<TestedForm>& tested_forms) {
    return std::ranges::any_of(tested_forms,
                               [](const TestedForm& tested_form) { return tested_form.against != nullptr; });
}

bool marches_any(const std::vector<TestedForm>& tested_forms) {
    return std::ranges::any_of(tested_forms,
                               [](const TestedForm& tested_form) { return !is_primitive(tested_form.form->shape); });
}

}  // namespace

std::vector<const Metric*> applicable_metrics(std::vector<const Metric*> metrics,
                                              const std::vector<TestedForm>& tested_forms, const std::string& subject) {
    if (!compares_any(tested_forms) && !metrics.empty()) {
        std::erase_if(metrics, compares_forms);
        if (metrics.empty())
            throw InputError("--metric against, apart: need --against FORM, the form to compare the others with");
    }
    if (metrics.empty()) return metrics;

    const std::string message_prefix = fmt::format("--metric {}: ", metrics.front()->name);
    // Drops the metrics for which `is_about` is true if no tested form `has` what they need. It is an error if none is
    // left.
    const auto drop_unless = [&](const auto& has, const auto& is_about, const std::string& lack) {
        if (std::ranges::any_of(tested_forms, has)) return;
        std::erase_if(metrics, is_about);
        if (metrics.empty()) throw InputError(message_prefix + lack);
    };

    using namespace measure::metric;
    drop_unless(
        [](const TestedForm& tested_form) { return tested_form.form->deciding_arithmetic != nullptr; },
        [](const Metric* m) { return (m->needs & needs_deciding_arithmetic) != 0; },
        fmt::format(
            "none of the selected forms in {} filters, that is, uses a wider format if it must; add -i '*.filtered'",
            subject));
    drop_unless([](const TestedForm& tested_form) { return tested_form.form->shapes().have_transform(); },
                [](const Metric* m) { return (m->needs & needs_steps) != 0; },
                fmt::format("no primitive of {} has a transform, so no ray has steps of a transform", subject));
    drop_unless([](const TestedForm& tested_form) { return intersect::bounding_box::has_box(*tested_form.form); },
                [](const Metric* m) { return m->name == "lost_to" || m->name == "end_margin"; },
                fmt::format("none of the selected forms in {} is behind a box; select FORM^BOX", subject));
    drop_unless([](const TestedForm& tested_form) { return !is_primitive(tested_form.form->shape); },
                [](const Metric* m) { return m->domain == MetricDomain::marches; },
                fmt::format("none of the selected forms marches in {}; add -i 'sdf.*', or a [march] table", subject));
    return metrics;
}

void require_applicable_metrics(const std::vector<const Metric*>& metrics, const std::vector<TestedForm>& tested_forms,
                                const std::string& subject) {
    static_cast<void>(applicable_metrics(metrics, tested_forms, subject));
}

namespace {

/// Says why the t of a form cannot be compared with that of another one, which the user calls `other_name`.
std::string incomparable_text(const intersect::Info& form, const intersect::Info& other, std::string_view other_name) {
    const bool has_no_t = form.roots == intersect::Roots::none, other_has_no_t = other.roots == intersect::Roots::none;
    if (has_no_t || other_has_no_t) return fmt::format("{} returns no t", has_no_t ? form.name : other_name);
    const bool takes_unit = form.direction == intersect::Direction::unit;
    return fmt::format("{} takes unit directions and {} any, so their t have different units",
                       takes_unit ? form.name : other_name, takes_unit ? other_name : form.name);
}

}  // namespace

void compare_against(std::vector<TestedForm>& tested_forms, const std::string& name, bool quiet) {
    const auto matching_forms = select_forms({name}, "--against");
    if (matching_forms.size() != 1)
        throw InputError(fmt::format("--against {}: this pattern names several forms; name one form", name));

    // Drops the forms for other shapes and formats.
    const Intersector& against_form = *matching_forms.front();
    const auto is_comparable = [&against_form](const TestedForm& tested_form) {
        // Keep single forms that may become parts of a set.
        const bool can_be_part =
            against_form.is_set() && !tested_form.form->is_set() && against_form.shapes().has(tested_form.form->shape);
        return (can_be_part || tested_form.form->shapes() == against_form.shapes()) &&
               against_form.exists_in(tested_form.format);
    };
    std::erase_if(tested_forms,
                  [&is_comparable](const TestedForm& tested_form) { return !is_comparable(tested_form); });
    const std::string formats = formats_text(against_form);
    if (tested_forms.empty())
        throw InputError(
            fmt::format("--against {}: this form intersects {}, in {}; no selected form can be compared with it; "
                        "select forms for the same shapes and formats with -i and -f",
                        name, against_form.is_set() ? "a scene of several shapes" : with_article(against_form.shape),
                        formats == "all" ? "all formats" : formats));

    for (TestedForm& tested_form : tested_forms) {
        tested_form.against = &against_form;
        if (quiet || measure::answer::are_comparable(*tested_form.form->info, *against_form.info)) continue;

        fmt::print(stderr, "lostbits: {} against {}: {}; only their decisions are compared\n",
                   tested_form.form->info->name, name,
                   incomparable_text(*tested_form.form->info, *against_form.info, name));
    }
}

void add_comparison_metrics(std::vector<const Metric*>& metrics) {
    for (const Metric& metric : measure::metric::metrics())
        if (compares_forms(&metric)) append_if_missing(metrics, &metric);
}

void note_forms_without_formula(const std::vector<const Metric*>& metrics, const std::vector<TestedForm>& tested_forms,
                                bool quiet) {
    std::string forms;
    for (const TestedForm& tested_form : tested_forms) {
        const std::string name(tested_form.form->info->name);
        if (!tested_form.form->is_template() && forms.find(name) == std::string::npos)
            forms += (forms.empty() ? "" : ", ") + name;
    }
    if (forms.empty()) return;

    const bool all_lack_operations = std::ranges::none_of(
        tested_forms, [](const TestedForm& tested_form) { return tested_form.form->is_template(); });
    for (const Metric* m : metrics) {
        if (!(m->needs & (measure::metric::needs_unrounded | measure::metric::needs_attribution))) continue;
        const std::string why =
            fmt::format("--metric {}: cannot be measured for {}, whose operations are not known", m->name, forms);
        if (all_lack_operations)
            throw InputError(why + "; a form over any number shows its operations (docs/your-own-form.md)");
        if (!quiet) fmt::print(stderr, "lostbits: {}\n", why);
    }
}

std::vector<const Metric*> with_default_metrics(const std::vector<const Metric*>& given,
                                                const std::vector<TestedForm>& tested_forms) {
    const bool marches = marches_any(tested_forms);
    std::vector<const Metric*> all;
    for (const Metric& metric : measure::metric::metrics()) {
        const bool is_given = std::ranges::find(given, &metric) != given.end();
        if (compares_forms(&metric) && !compares_any(tested_forms)) continue;
        if ((metric.is_default || is_given) && (marches || metric.domain != measure::metric::MetricDomain::marches))
            all.push_back(&metric);
    }
    std::ranges::copy_if(given, std::back_inserter(all), [](const Metric* m) { return !m->label.empty(); });
    return all;
}

std::vector<Format> select_formats(const std::vector<std::string>& names, const char* option) {
    std::vector<Format> formats;
    const auto add = [&formats, option](const std::string& name) {
        const auto format = find_format(name);
        if (!format) fail_unknown_format(name, option);
        append_if_missing(formats, *format);
    };
    for (const std::string& name : names) {
        const auto dots = name.find("..");
        if (dots == std::string::npos) {
            add(name);
            continue;
        }
        const auto first = find_format(name.substr(0, dots)), last = find_format(name.substr(dots + 2));
        const bool are_widths = first && last && first->name.front() == 'p' && last->name.front() == 'p';
        if (!are_widths || first->parameters.precision > last->parameters.precision) fail_unknown_format(name, option);
        for (int p = first->parameters.precision; p <= last->parameters.precision; ++p) add("p" + std::to_string(p));
    }
    return formats;
}

std::string formats_text(const Intersector& form) {
    if (form.rounded != nullptr) return "all";
    if (form.native32 && form.native64) return "f32 and f64";
    return form.native32 ? "f32" : "f64";
}

std::vector<TestedForm> pair_forms_with_formats(const std::vector<const Intersector*>& forms,
                                                const std::vector<Format>& formats) {
    std::vector<TestedForm> tested_forms;
    for (const Intersector* form : forms) {
        for (const Format& format : formats) {
            if (form->exists_in(format)) tested_forms.push_back({form, format});
        }
    }
    if (tested_forms.empty()) {
        std::string format_names;
        for (const Format& format : formats) format_names += (format_names.empty() ? "" : ", ") + format.name;
        const Intersector& example = *forms.at(0);
        throw NothingSelected(
            fmt::format("none of the selected forms exists in {}; {} exists in {}: choose one of its formats with -f "
                        "(`lostbits list forms` lists the formats of each form)",
                        format_names, example.info->name, formats_text(example)));
    }
    return tested_forms;
}

std::vector<std::string> list_suspicions(
    const std::vector<measure::evaluate::TestedForm>& tested_forms,
    const std::function<std::string(const measure::evaluate::TestedForm&)>& suspicion) {
    // A t that is off by 2^-8 counts as wrong. In a narrower format rounding alone explains it: 2^-8 is one ulp of
    // bf16.
    constexpr int min_precision = 16;
    const auto catalogue = intersect::table::catalogue();
    std::vector<std::string> lines;
    for (const measure::evaluate::TestedForm& tested_form : tested_forms) {
        if (tested_form.form >= catalogue.data() && tested_form.form < catalogue.data() + catalogue.size()) continue;
        if (tested_form.format.parameters.precision < min_precision) continue;
        const std::string text = suspicion(tested_form);
        if (!text.empty())
            lines.push_back(fmt::format("{} {}: {}", tested_form.form->info->name, tested_form.format.name, text));
    }
    return lines;
}

}  // namespace lostbits::analysis::selection
