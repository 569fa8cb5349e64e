// Columns of the summary of offsets.
#include "measure/offset/offsets.hpp"
#include "output/offset/offset_files.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::offset {

namespace {

/// Columns of the numbers of a strategy on one side.
table::Table<StrategyRow> number_columns() {
    using measure::offset::Fault;
    using table::fraction_or_missing, table::percentile, table::Table;
    using R = StrategyRow;
    using OfSide = measure::offset::SideSummary;
    using OfStrategy = measure::offset::StrategySummary;
    const auto rays_with = [](Fault fault) {
        return [fault](const R& r) {
            return fraction_or_missing(r.strategy_summary()[fault], r.side_summary().ray_count);
        };
    };
    const auto points_with = [](std::uint64_t OfSide::*points) {
        return [points](const R& r) { return fraction_or_missing(r.side_summary().*points, r.summary->points); };
    };

    Table<R> table{
        {"points", "pixels where the form hits the primitive that the ray truly hits first, and the point is finite",
         [](const R& r) { return r.summary->points; }},
        {"rays", "next rays that leave these points to this side",
         [](const R& r) { return r.side_summary().ray_count; }},
        {"bad_fraction", "share of rays with any fault other than a start on the wrong side, which alone harms nothing",
         [](const R& r) {
             return fraction_or_missing(r.strategy_summary().bad_ray_count, r.side_summary().ray_count);
         }},
        {"self_hit_fraction",
         "share of rays that truly meet the primitive that they leave, except for its far wall; for rays into the "
         "primitive: the surface at which they start",
         rays_with(Fault::self_hit)},
        {"self_hit_by_form_fraction", "share of rays with a self-hit by the form's own arithmetic",
         rays_with(Fault::self_hit_by_form)},
        {"lost_occluder_fraction",
         "share of rays that start behind a surface that they should have met: that of another primitive, or a far "
         "wall of their own",
         rays_with(Fault::lost_occluder)},
        {"begins_in_neighbour_fraction",
         "share of rays that start inside another primitive, though their point does not lie there",
         rays_with(Fault::begins_in_neighbour)},
        {"lost_exit_fraction",
         "share of rays into the primitive that truly start past its far side, or are not tested against it",
         rays_with(Fault::lost_exit)},
        {"lost_exit_by_form_fraction", "share of rays into the primitive for which the form finds no exit",
         rays_with(Fault::lost_exit_by_form)},
        {"wrong_side_fraction",
         "share of rays to the outside that start inside the primitive, or of rays to the inside that do not start "
         "in it",
         rays_with(Fault::wrong_side)},
        {"not_finite_fraction", "share of rays whose new origin is not finite", rays_with(Fault::not_finite)}};
    table.add<OfStrategy>(
        {{"offset_p50", "world units", "median over the points of the largest distance from p to a new origin",
          percentile(&OfStrategy::offset_size, 50)},
         {"offset_max", "world units", "maximum over the points of the largest distance from p to a new origin",
          percentile(&OfStrategy::offset_size, 100)},
         {"oversize_points", "points whose smallest safe offset is finite and not 0",
          [](const OfStrategy& s) { return s.size_ratio.count(); }},
         {"oversize_p50", "of these, how many times larger the offset is than the smallest safe one: median",
          percentile(&OfStrategy::size_ratio, 50)},
         {"oversize_p99", "the same: 99th percentile", percentile(&OfStrategy::size_ratio, 99)},
         {"oversize_max", "the same: largest", percentile(&OfStrategy::size_ratio, 100)},
         {"too_small_fraction", "share of these points whose offset is less than the smallest safe one",
          [](const OfStrategy& s) { return fraction_or_missing(s.too_small_point_count, s.size_ratio.count()); }}},
        &R::strategy_summary);
    table.add({{"already_safe_fraction", "share of points that need no offset",
                points_with(&OfSide::already_safe_point_count)},
               {"never_safe_fraction", "share of points that no offset along the normal makes safe",
                points_with(&OfSide::never_safe_point_count)}});
    table.add<OfSide>(
        {{"safe_p50", "world units", "smallest safe offset of the points that have one, 0 among them: median",
          percentile(&OfSide::safe_offset, 50)},
         {"safe_p99", "world units", "the same: 99th percentile", percentile(&OfSide::safe_offset, 99)},
         {"safe_max", "world units", "the same: largest", percentile(&OfSide::safe_offset, 100)},
         {"safe_ulps_p50", "ulp", "the same in ulps of the largest coordinate of p: median",
          percentile(&OfSide::safe_ulps, 50)},
         {"safe_ulps_p99", "ulp", "the same: 99th percentile", percentile(&OfSide::safe_ulps, 99)},
         {"safe_ulps_max", "ulp", "the same: largest", percentile(&OfSide::safe_ulps, 100)}},
        &R::side_summary);
    table.add(
        {"never_quiet_fraction",
         "share of points that no offset along the normal makes safe both by truth and by the form's own arithmetic",
         points_with(&OfSide::never_quiet_point_count)});
    table.add<OfSide>(
        {{"quiet_p50", "world units", "smallest offset that is safe by truth and by the form's arithmetic: median",
          percentile(&OfSide::quiet_offset, 50)},
         {"quiet_p99", "world units", "the same: 99th percentile", percentile(&OfSide::quiet_offset, 99)},
         {"quiet_max", "world units", "the same: largest", percentile(&OfSide::quiet_offset, 100)}},
        &R::side_summary);
    return table;
}

}  // namespace

table::Table<StrategyRow> OffsetPresentation::make_summary_table() {
    using R = StrategyRow;
    table::Table<R> table{{"strategy", "rule for the new origin: a name of `lostbits list strategies`",
                           [](const R& r) { return r.strategy->name; }},
                          {"side", "side of the new rays: outside (light, mirror, hemisphere) or inside (refraction)",
                           [](const R& r) { return name_of(r.side); }},
                          {"point", "starting point: as computed, or projected back onto the surface",
                           [](const R& r) { return name_of(r.offset_form->point_kind); }}};
    table.add(
        table::make_subject_columns("form that finds the points and is tested for self-hits",
                                    "format of all computations"),
        [](const R& r) -> const auto& { return r.offset_form->tested_form; });
    table.add({"operations", "operations per new ray, as the strategy is written",
               [](const R& r) { return r.strategy->operation_count(r.offset_form->tested_form.form->shape); }});
    table.add(number_columns());
    return table;
}

}  // namespace lostbits::output::offset
