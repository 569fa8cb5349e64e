// Looks of the lines of a plot, and series that share a line.
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

bool same(const std::vector<double>& a, const std::vector<double>& b) {
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

void check(const Series& series) {
    const bool band = !series.low.empty() || !series.high.empty();
    if (series.x.size() != series.y.size() ||
        (band && (series.low.size() != series.x.size() || series.high.size() != series.x.size()))) {
        throw std::invalid_argument("line plot: series " + series.label + " has columns of different lengths");
    }
}

}  // namespace

image::Rgb8 look_colour(std::size_t look) { return palette[look % palette.size()]; }

namespace {

/// Assigns looks and dashes. No two are alike while any are left.
class Looks {
public:
    /// Takes all series, so that one that shares its line here looks as it does in a plot where it has its own.
    explicit Looks(std::span<const Series> all) {
        for (const Series& series : all) {
            if (series.look) asked_.insert(*series.look % look_count);
        }
        part_colours(all);
        skip_taken();
    }

    void give(PlotLine& line) {
        const Series& series = *line.series;
        std::size_t look = series.look ? drawn_.at(*series.look % look_count) : next_;
        if (!series.look && !series.family.empty()) look = families_.try_emplace(series.family, next_).first->second;
        int pattern = series.dashed ? 1 : 0;
        for (std::size_t tried = 0; !find_free(look, pattern) && tried < look_count; ++tried)
            look = (look + 1) % look_count;
        taken_[look].insert(pattern);
        line.colour = look_colour(look);
        line.marker = static_cast<int>(look / line_colours);
        line.dashes = dashes_of(pattern);
        skip_taken();
    }

private:
    /// Gives every look a colour of its own while there are no more looks than colours. Of two looks with the same
    /// colour the later one gets a free colour and keeps its marker.
    void part_colours(std::span<const Series> all) {
        for (const std::size_t look : asked_) drawn_.emplace(look, look);
        if (asked_.size() > line_colours) return;
        std::set<std::size_t> wanted, given;
        for (const std::size_t look : asked_) wanted.insert(look % line_colours);
        std::set<std::size_t> seen;
        for (const Series& series : all) {
            if (!series.look || !seen.insert(*series.look % look_count).second) continue;
            const std::size_t look = *series.look % look_count;
            std::size_t colour = look % line_colours;
            if (given.contains(colour))
                for (colour = 0; wanted.contains(colour) || given.contains(colour);) ++colour;
            given.insert(colour);
            drawn_[look] = look - look % line_colours + colour;
        }
        asked_.clear();
        for (const auto& [look, drawn] : drawn_) asked_.insert(drawn);
    }

    void skip_taken() {
        while (next_ < look_count - 1 && (asked_.contains(next_) || taken_.contains(next_))) ++next_;
    }

    /// Finds the first pattern, from `pattern` on, that no line of the look has.
    bool find_free(std::size_t look, int& pattern) {
        for (int k = pattern; k < dash_patterns; ++k) {
            if (taken_[look].contains(k)) continue;
            pattern = k;
            return true;
        }
        return false;
    }

    std::set<std::size_t> asked_;
    std::map<std::size_t, std::size_t> drawn_;  ///< drawn look of each requested look
    std::map<std::string, std::size_t> families_;
    std::map<std::size_t, std::set<int>> taken_;
    std::size_t next_ = 0;
};

}  // namespace

std::vector<PlotLine> plot_lines(std::span<const Series> series) {
    std::vector<PlotLine> lines;
    std::vector<int> alike;  // number of series of each line
    for (const auto& one : series) {
        check(one);
        const auto twin = std::ranges::find_if(lines, [&](const PlotLine& line) {
            const Series& other = *line.series;
            return same(one.x, other.x) && same(one.y, other.y) && same(one.low, other.low) &&
                   same(one.high, other.high);
        });
        if (twin == lines.end()) {
            lines.push_back({&one, one.label, {}, 0, {}, one.key});
            alike.push_back(1);
        } else {
            twin->label += ", " + one.label;
            twin->keys += " " + one.key;
            ++alike[static_cast<std::size_t>(twin - lines.begin())];
            if (!one.dashed && twin->series->dashed) twin->series = &one;
        }
    }
    for (std::size_t k = 0; k < lines.size(); ++k) {
        if (alike[k] > 1) lines[k].label = std::to_string(alike[k]) + " alike: " + lines[k].label;
    }
    Looks looks(series);
    for (PlotLine& line : lines) looks.give(line);
    return lines;
}

}  // namespace lostbits::output::plot
