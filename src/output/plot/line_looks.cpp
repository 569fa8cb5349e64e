// Assigns looks to the lines of a plot, and finds series that share a line.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "output/plot/line_plot_parts.hpp"

namespace lostbits::output::plot {

namespace {

// Okabe and Ito 2008, but with a wine red in place of the yellow, which is hard to see on a light page.
constexpr std::array<image::Rgb8, line_colours> palette{{
    {0, 114, 178},
    {213, 94, 0},
    {0, 158, 115},
    {204, 121, 167},
    {32, 32, 36},
    {230, 159, 0},
    {86, 180, 233},
    {136, 34, 85},
}};
constexpr int dash_patterns = 5;

constexpr std::array<double, 2> dash{7, 4}, dots{2, 3};
constexpr std::array<double, 4> dash_dot{11, 3, 2, 3};
constexpr std::array<double, 6> dash_dot_dot{11, 3, 2, 3, 2, 3};

bool are_drawn_alike(const std::vector<double>& a, const std::vector<double>& b) {
    // Two NaNs are the same, and 0 and -0 are drawn alike.
    return std::ranges::equal(a, b, [](double p, double q) { return p == q || (std::isnan(p) && std::isnan(q)); });
}

std::span<const double> dashes_of(int pattern) {
    switch (pattern % dash_patterns) {
        case 1: return dash;
        case 2: return dash_dot;
        case 3: return dots;
        case 4: return dash_dot_dot;
        default: return {};
    }
}

void require_equal_lengths(const Series& series) {
    const bool has_band = !series.low.empty() || !series.high.empty();
    if (series.x.size() != series.y.size() ||
        (has_band && (series.low.size() != series.x.size() || series.high.size() != series.x.size()))) {
        throw std::invalid_argument("line plot: series " + series.label + " has columns of different lengths");
    }
}

}  // namespace

image::Rgb8 look_colour(std::size_t look) { return palette[look % palette.size()]; }

namespace {

/// Assigns looks (colours and markers) and dashes to lines. No two lines are alike while an unused combination is left.
class LookAssigner {
public:
    /// Takes all series, also those that share a line, so that a series looks the same in a plot where it has a line of
    /// its own.
    explicit LookAssigner(std::span<const Series> series_list) {
        for (const Series& series : series_list) {
            if (series.look) requested_looks_.insert(*series.look % look_count);
        }
        separate_colours(series_list);
        advance_next_look();
    }

    void assign_look(PlotLine& line) {
        const Series& series = *line.series;
        std::size_t look = series.look ? drawn_looks_.at(*series.look % look_count) : next_look_;
        if (!series.look && !series.family.empty())
            look = family_looks_.try_emplace(series.family, next_look_).first->second;

        // If all dashes of the look are taken, the next look with free dashes is used.
        int pattern = series.is_dashed ? 1 : 0;
        for (std::size_t attempt_count = 0; !find_free_pattern(look, pattern) && attempt_count < look_count;
             ++attempt_count)
            look = (look + 1) % look_count;
        used_patterns_[look].insert(pattern);

        line.colour = look_colour(look);
        line.marker = static_cast<int>(look / line_colours);
        line.dashes = dashes_of(pattern);
        advance_next_look();
    }

private:
    /// Gives every look a colour of its own while there are no more looks than colours. If two looks have the same
    /// colour, the later one gets a free colour and keeps its marker.
    void separate_colours(std::span<const Series> series_list) {
        for (const std::size_t look : requested_looks_) drawn_looks_.emplace(look, look);
        if (requested_looks_.size() > line_colours) return;

        std::set<std::size_t> requested_colours, used_colours;
        for (const std::size_t look : requested_looks_) requested_colours.insert(look % line_colours);
        std::set<std::size_t> seen_looks;
        for (const Series& series : series_list) {
            if (!series.look || !seen_looks.insert(*series.look % look_count).second) continue;
            const std::size_t look = *series.look % look_count;
            std::size_t colour = look % line_colours;
            if (used_colours.contains(colour))
                for (colour = 0; requested_colours.contains(colour) || used_colours.contains(colour);) ++colour;
            used_colours.insert(colour);
            drawn_looks_[look] = look - look % line_colours + colour;
        }

        requested_looks_.clear();
        for (const auto& [look, drawn_look] : drawn_looks_) requested_looks_.insert(drawn_look);
    }

    void advance_next_look() {
        while (next_look_ < look_count - 1 &&
               (requested_looks_.contains(next_look_) || used_patterns_.contains(next_look_)))
            ++next_look_;
    }

    /// Finds the first pattern, from `pattern` on, that no line of the look has.
    bool find_free_pattern(std::size_t look, int& pattern) {
        for (int k = pattern; k < dash_patterns; ++k) {
            if (used_patterns_[look].contains(k)) continue;
            pattern = k;
            return true;
        }
        return false;
    }

    std::set<std::size_t> requested_looks_;
    std::map<std::size_t, std::size_t> drawn_looks_;  ///< for each requested look, the look that is drawn
    std::map<std::string, std::size_t> family_looks_;
    std::map<std::size_t, std::set<int>> used_patterns_;
    std::size_t next_look_ = 0;
};

}  // namespace

std::vector<PlotLine> plot_lines(std::span<const Series> series) {
    std::vector<PlotLine> lines;
    std::vector<int> series_counts;  // number of series of each line
    for (const auto& current : series) {
        require_equal_lengths(current);

        // A series with the same points joins the line of an earlier one.
        const auto equal_line = std::ranges::find_if(lines, [&](const PlotLine& line) {
            const Series& other = *line.series;
            return are_drawn_alike(current.x, other.x) && are_drawn_alike(current.y, other.y) &&
                   are_drawn_alike(current.low, other.low) && are_drawn_alike(current.high, other.high);
        });
        if (equal_line == lines.end()) {
            lines.push_back({&current, current.label, {}, 0, {}, current.key});
            series_counts.push_back(1);
        } else {
            equal_line->label += ", " + current.label;
            equal_line->keys += " " + current.key;
            ++series_counts[equal_line - lines.begin()];
            if (!current.is_dashed && equal_line->series->is_dashed) equal_line->series = &current;
        }
    }

    for (std::size_t k = 0; k < lines.size(); ++k) {
        if (series_counts[k] > 1) lines[k].label = std::to_string(series_counts[k]) + " alike: " + lines[k].label;
    }

    LookAssigner assigner(series);
    for (PlotLine& line : lines) assigner.assign_look(line);
    return lines;
}

}  // namespace lostbits::output::plot
