// Tables and cases of the worst rays that searches find.
#include "output/sweep/worst_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "output/attribution/explain_command.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"
#include "output/map/form_names.hpp"
#include "output/table/shared_columns.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::sweep {

using measure::answer::Outcome;
using measure::edges::NearestRay;
using measure::edges::searched_outcomes;
using measure::sweep::WorstRequest;
using measure::sweep::WorstResult;
using table::or_missing;

namespace {

std::string hex_array(std::span<const double> x) { return "[\"" + file::number_list(x, file::hex, "\", \"") + "\"]"; }

std::string primitive_text(const Primitive<double>& primitive) {
    std::string keys;
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        keys += fmt::format("{} {} = ", keys.empty() ? "" : ",", key.name);
        keys += key.count() == 3 ? hex_array(primitive.shape_numbers().subspan(k, 3))
                                 : fmt::format("\"{}\"", file::hex(primitive.numbers[k]));
    });
    if (primitive.transform)
        keys += fmt::format(", {} = {}", primitive.transform->is_inverse ? "inverse_matrix" : "matrix",
                            hex_array(primitive.transform->matrix));
    return fmt::format("{{{} }}", keys);
}

}  // namespace

std::string case_file_head(const std::string& title, const std::string& source) {
    return fmt::format("schema = \"lostbits-sweep/1\"\ntitle = {}\nsource = {}\n", file::toml_string(title),
                       file::toml_string(source));
}

std::string case_text(const std::string& name, const scene::rays::RayGroup& group) {
    std::vector<std::pair<Shape, std::string>> lists;  // in the order of the first primitive of each shape
    for (const Primitive<double>& primitive : group.primitives) {
        auto list = std::ranges::find(lists, primitive.shape, &std::pair<Shape, std::string>::first);
        if (list == lists.end()) list = lists.insert(list, {primitive.shape, ""});
        list->second += (list->second.empty() ? "" : ", ") + primitive_text(primitive);
    }
    std::string primitives;
    for (const auto& [shape, list] : lists) primitives += fmt::format("{} = [{}]\n", row_of(shape).plural, list);

    const Ray<double> ray = group.rays[0];
    const std::array origin{ray.origin.x, ray.origin.y, ray.origin.z};
    const std::array direction{ray.direction.x, ray.direction.y, ray.direction.z};
    const Range<double> range = group.rays.range(0);
    const std::string_view open = name_of(range.open_ends);
    return fmt::format("\n[[case]]\nname = {}\n{}{}rays = [{{ origin = {}, direction = {}{}{} }}]\n",
                       file::toml_string(name), open == "none" ? "" : fmt::format("open_ends = \"{}\"\n", open),
                       primitives, hex_array(origin), hex_array(direction),
                       range.tmin == 0 ? "" : fmt::format(", tmin = \"{}\"", file::hex(range.tmin)),
                       std::isinf(range.tmax) ? "" : fmt::format(", tmax = \"{}\"", file::hex(range.tmax)));
}

namespace {

struct WorstRow {
    measure::evaluate::TestedForm tested_form;
    const std::optional<WorstResult>& worst;
};

scene::rays::RayGroup make_worst_group(const WorstResult& worst) {
    scene::rays::RayGroup group = scene::rays::make_group(worst.ray);
    group.primitives = {worst.primitive};
    return group;
}

table::Table<WorstRow> make_worst_table(const WorstRequest& request) {
    using R = WorstRow;
    using W = WorstResult;
    const measure::metric::Metric& metric =
        *request.metrics[measure::metric::index_of(request.metrics, request.search.metric)];
    const auto worst = [](const R& r) -> const std::optional<W>& { return r.worst; };
    table::Table<R> table;
    table.add(table::make_subject_columns(), &R::tested_form);
    table.add(
        {"found", "true if the form hit anything within the ranges", [](const R& r) { return r.worst.has_value(); }});

    // The worst ray: how bad it is, the answer, and the ray itself.
    table::Table<W> columns{
        {"outcome", "outcome of the worst ray",
         [](const W& w) { return measure::answer::outcome_names[static_cast<std::size_t>(w.outcome)]; }},
        {std::string(metric.name), std::string(metric.unit),
         "value for the worst ray; missing if its decision is wrong",
         [](const W& w) { return table::when(w.outcome == Outcome::agree_hit, w.value); }},
        {"distance_radii", "r",
         "distance from the ray's origin to the centre of the sphere; missing for other primitives",
         or_missing(&W::distance)},
        {"evaluations", "rays tried", &W::evaluation_count}};
    columns.add_exact({"t", "t", "the form's answer, in its own unit",
                       [](const W& w) { return table::when(w.outcome != Outcome::false_miss, w.t); }});
    columns.add_exact({"truth", "t", "t*, correctly rounded to binary64, in the same unit; missing for a miss",
                       or_missing(&W::truth)});
    columns.add(table::make_ray_columns("of the worst ray"), &W::ray);
    columns.add(table::make_primitive_columns(request.search.shape, "of its primitive"), &W::primitive);
    table.add(columns, worst);
    return table.add(
        {"explain", "the command that explains the worst ray and prints these numbers again", [](const R& r) {
             if (!r.worst) return std::string();
             const scene::rays::RayGroup group = make_worst_group(*r.worst);
             return attribution::explain_command(attribution::explain_ray_arguments(&group), r.tested_form);
         }});
}

std::string worst_case_text(const WorstRequest& request, const measure::evaluate::TestedForm& tested_form,
                            const WorstResult& worst) {
    const bool is_agreed_hit = worst.outcome == Outcome::agree_hit;
    std::string result_text =
        is_agreed_hit ? fmt::format("{} {:.6g}", request.search.metric, worst.value)
                      : std::string(measure::answer::outcome_names[static_cast<std::size_t>(worst.outcome)]);
    if (!is_agreed_hit && request.search.nearest) result_text += fmt::format(" at {:.6g} radii", worst.distance);
    return case_text(fmt::format("{} in {}: {}", tested_form.form->info->name, tested_form.format.name, result_text),
                     make_worst_group(worst));
}

}  // namespace

void write_worst(const std::filesystem::path& folder, const WorstRequest& request,
                 const std::vector<std::optional<WorstResult>>& results) {
    const scene::sweep::SearchFile& search = request.search;
    table::TableFile<WorstRow> csv(folder, "worst.csv", "One row per form and format: the worst ray found",
                                   make_worst_table(request));
    file::AtomicFile hard_cases(folder / "hard.toml");

    // The file of cases begins with the command that found them.
    const std::string title = "The worst rays of each form: " + search.title;
    std::string text =
        case_file_head(title.size() > scene::toml::TableReader::max_title_bytes ? search.title : title,
                       fmt::format("lostbits sweep {} --worst: seed {}, {} starts of {} generations of 32, {} {}",
                                   search.id, search.seed, search.start_count, search.generation_count,
                                   search.is_minimised ? "smallest" : "largest", search.metric) +
                           (search.nearest ? ", nearest wrong decision" : ""));

    for (std::size_t r = 0; r < results.size(); ++r) {
        csv.add({request.tested_forms[r], results[r]});
        if (results[r]) text += worst_case_text(request, request.tested_forms[r], *results[r]);
    }

    hard_cases.write(text);
    hard_cases.commit();
    table::close_tables(folder, search.title, csv);
}

namespace {

std::string searched_name(std::size_t outcome) {
    return std::string(measure::answer::outcome_names[static_cast<std::size_t>(searched_outcomes.at(outcome))]);
}

struct NearestRow {
    measure::evaluate::TestedForm tested_form;
    std::string outcome;
    std::uint64_t rays;
    const std::optional<NearestRay>& nearest;
    std::string explain;
};

table::Table<NearestRow> nearest_table() {
    using R = NearestRow;
    using N = NearestRay;
    const auto nearest = [](const R& r) -> const std::optional<N>& { return r.nearest; };
    table::Table<R> table;
    table.add(table::make_subject_columns(), &R::tested_form);

    // The search.
    table.add(
        {{"outcome", "the outcome that was searched for: crack or double_hit", &R::outcome},
         {"found", "true if a ray with that outcome was found", [](const R& r) { return r.nearest.has_value(); }}});
    table.add<N>(
        {{"distance_edges", "1",
          "distance of the nearest such ray, in edge lengths: from the eye to the point on the edge that it aims at",
          &N::distance}},
        nearest);
    table.add({"rays", "rays tried", &R::rays});

    // The nearest ray: the edge, the answer, and the ray itself.
    table.add<N>({{"face_a", "index of one triangle of the edge among the primitives of the scene",
                   [](const N& n) { return n.faces[0]; }},
                  {"face_b", "index of the other triangle", [](const N& n) { return n.faces[1]; }},
                  {"t", "t", "the form's answer, in its own unit; missing if it misses", or_missing(&N::t)},
                  {"truth", "t", "t*, correctly rounded to binary64, in the same unit", &N::true_t}},
                 nearest);
    table.add(table::make_ray_columns("of the nearest ray"),
              [](const R& r) { return r.nearest ? &r.nearest->ray : nullptr; });
    return table.add({"explain", "the command that explains that ray", &R::explain});
}

struct CensusRow {
    measure::evaluate::TestedForm tested_form;
    std::size_t target;
    const measure::edges::EdgeCounts& count;
};

table::Table<CensusRow> make_census_table() {
    using R = CensusRow;
    table::Table<R> table;
    table.add(table::make_subject_columns(), &R::tested_form);
    table.add(
        {{"target", "what the rays are aimed at: points of an edge, or its ends (vertex)",
          [](const R& r) { return std::string(measure::edges::edge_target_names.at(r.target)); }},
         {"rays", "rays, from all distances of the search", [](const R& r) { return r.count.ray_count; }},
         {"crack", "rays that the form lets through the surface", [](const R& r) { return r.count.outcome_counts[0]; }},
         {"double_hit",
          "crossings that the form counts twice, not counting rays that truly meet two triangles at one t",
          [](const R& r) { return r.count.outcome_counts[1]; }}});
    return table;
}

/// The counts of a census in words: `12 cracks and 3 double hits of 15000 rays at edges, none of 5000 at vertices`.
std::string census_phrase(const measure::edges::EdgeResults& finding) {
    std::string text;
    for (std::size_t k = 0; k < finding.census.size(); ++k) {
        const auto& [rays, outcomes] = finding.census.at(k);
        if (rays == 0) continue;
        const std::string counts = outcomes[0] + outcomes[1] == 0
                                       ? "none"
                                       : text::count_with_noun(outcomes[0], "crack") + " and " +
                                             text::count_with_noun(outcomes[1], "double hit");
        text += fmt::format("{}{} of {}{}", text.empty() ? "" : ", ", counts,
                            text.empty() ? text::count_with_noun(rays, "ray") : std::to_string(rays),
                            k == 0 ? " at edges" : " at vertices");
    }
    return text;
}

}  // namespace

void NearestWriter::write(const std::filesystem::path& folder) const {
    const auto explain = [this](std::size_t r, const NearestRay& nearest) {
        const scene::rays::RayGroup group = scene::rays::make_group(nearest.ray);
        return attribution::explain_command(scene_argument + " " + attribution::explain_ray_arguments(&group),
                                            request.tested_forms[r]);
    };

    table::TableFile<NearestRow> csv(
        folder, "worst.csv", "One row per form, format and outcome: the nearest ray found at an edge", nearest_table());
    for (std::size_t r = 0; r < findings.size(); ++r) {
        for (std::size_t k = 0; k < searched_outcomes.size(); ++k) {
            const auto& nearest = findings[r].nearest.at(k);
            csv.add({request.tested_forms[r], searched_name(k), findings[r].searched_ray_counts.at(k), nearest,
                     nearest ? explain(r, *nearest) : ""});
        }
    }

    table::TableFile<CensusRow> census(folder, "census.csv",
                                       "One row per form, format and target: cracks and double hits of the rays of the "
                                       "census",
                                       make_census_table());
    for (std::size_t r = 0; r < findings.size(); ++r)
        for (std::size_t k = 0; k < findings[r].census.size(); ++k)
            if (findings[r].census.at(k).ray_count > 0)
                census.add({request.tested_forms[r], k, findings[r].census.at(k)});
    table::close_tables(folder, request.search.title, csv, census);
}

std::string NearestWriter::sentence(std::size_t r) const {
    std::string text =
        fmt::format("{} in {}:", request.tested_forms[r].form->info->name, request.tested_forms[r].format.name);
    const std::string counts = census_phrase(findings[r]);
    if (!counts.empty()) text += " " + counts + ";";
    for (std::size_t k = 0; k < searched_outcomes.size(); ++k) {
        const std::string outcome_phrase = map::name_in_words(searched_name(k));
        const auto& nearest = findings[r].nearest.at(k);
        text += nearest
                    ? fmt::format("{} the nearest {} of {} rays is {:.4g} edge lengths away", k > 0 ? "," : "",
                                  outcome_phrase, findings[r].searched_ray_counts.at(k), nearest->distance)
                    : fmt::format("{}{} no {} among {}", k > 0 ? "," : "",
                                  counts.empty() || k > 0 ? "" : " the search for the nearest found", outcome_phrase,
                                  text::count_with_noun(findings[r].searched_ray_counts.at(k), "ray"));
    }
    return text;
}

}  // namespace lostbits::output::sweep
