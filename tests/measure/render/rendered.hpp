// All results of a rendered picture, and spheres by plain formulas in 256 bits.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "catch.hpp"
#include "measure/render/render.hpp"
#include "measure/rows.hpp"
#include "measure/study/study.hpp"
#include "number/real.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/rays.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::test {

using scene::file::Stage;

inline const std::vector<Stage> all_stages{Stage::visible, Stage::diffuse, Stage::shadows, Stage::phong};

inline std::vector<measure::evaluate::TestedForm> rows_of(const std::vector<std::string>& formats,
                                                          std::string_view only = "") {
    std::vector<measure::evaluate::TestedForm> tested_forms;
    for (const intersect::table::Intersector& form : intersect::table::intersectors(Shape::sphere)) {
        for (const auto& name : formats)
            if ((only.empty() || form.info->name == only) && form.exists_in(*find_format(name)))
                tested_forms.push_back({&form, *find_format(name)});
    }
    return tested_forms;
}

/// All results of one run.
struct Collected {
    explicit Collected(const measure::render::RenderStudy& study)
        : pictures(study.tested_forms.size()), shadows(pictures.size()), residuals(pictures.size()) {
        for (auto& p : pictures) p.resize(study.stages.size());
        auto rows = measure::study::run_study(
            study, {[this](std::size_t row, const measure::render::RenderBand& band) { add(row, band); }});
        for (auto& row : rows) std::ranges::move(row, std::back_inserter(summaries));
    }
    void add(std::size_t r, const measure::render::RenderBand& band) {
        if (r == 0) truth.insert(truth.end(), band.true_pixels.begin(), band.true_pixels.end());
        for (std::size_t s = 0; s < band.painted.size(); ++s)
            pictures[r][s].insert(pictures[r][s].end(), band.painted[s].begin(), band.painted[s].end());
        shadows[r].insert(shadows[r].end(), band.shadow.begin(), band.shadow.end());
        residuals[r].insert(residuals[r].end(), band.residual.begin(), band.residual.end());
    }
    std::vector<std::vector<std::vector<measure::render::PaintedPixel>>> pictures;  ///< row, stage, pixel
    std::vector<std::vector<measure::render::Shadow>> shadows;
    std::vector<std::vector<double>> residuals;
    std::vector<measure::render::TruePixel> truth;
    std::vector<measure::render::RenderSummary> summaries;
};

inline bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
inline bool same(const std::vector<measure::render::PaintedPixel>& a,
                 const std::vector<measure::render::PaintedPixel>& b) {
    return std::ranges::equal(a, b, [](const measure::render::PaintedPixel& x, const measure::render::PaintedPixel& y) {
        return same(x.colour.x, y.colour.x) && same(x.colour.y, y.colour.y) && same(x.colour.z, y.colour.z) &&
               x.byte == y.byte;
    });
}

// --- the same picture by plain formulas in 256 bits, sharing nothing with the one under test ---------------------

inline Real rounded(const Real& x) { return Real(scene::toml::round_to_format(x, binary32)); }
inline Vec<Real> rounded(const Vec<Real>& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }

/// The first t ≥ 0 of a line through a sphere, by the schoolbook.
inline std::optional<Real> first(const Vec<Real>& o, const Vec<Real>& d, const Vec<Real>& centre, const Real& r) {
    const Vec<Real> f = o - centre;
    const Real a = dot(d, d), h = dot(f, d), disc = h * h - a * (dot(f, f) - r * r);
    if (disc < 0) return std::nullopt;
    const Real root = sqrt(disc), near = (-h - root) / a, far = (-h + root) / a;
    if (far < 0) return std::nullopt;
    return near < 0 ? far : near;
}

}  // namespace lostbits::test
