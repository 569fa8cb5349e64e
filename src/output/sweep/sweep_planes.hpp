// The planes of sweeps with two axes: a picture and an EXR a row.
#pragma once

#include <filesystem>
#include <vector>

#include "measure/sweep/sweep.hpp"
#include "output/image/image.hpp"
#include "output/plot/plot_axis.hpp"

namespace lostbits::output::sweep {

/// A sweep's axis as a plot shows it.
plot::AxisSpec plot_axis(const scene::sweep::Axis& axis);
/// Rays with a wrong decision or NaN, among all.
double wrong_share(const measure::evaluate::FormSummary& s);

/// The steps of a sweep over two axes as a plane: columns by rising first axis, lines by rising second.
class SweepGrid {
public:
    SweepGrid(const measure::sweep::SweepRequest& request, const std::vector<measure::sweep::SweepStep>& steps);
    /// The numbers of one row of the request.
    [[nodiscard]] const measure::evaluate::FormSummary& at(std::size_t row, std::size_t column, std::size_t line) const;
    std::vector<double> x, y;

private:
    const std::vector<measure::sweep::SweepStep>& steps_;
    bool x_falls_, y_falls_;
};

/// What the outline in a plane says, here and on the page.
inline constexpr const char* outlined_means =
    "Outlined: the form loses a bit or more beyond what half an ulp in each input would cost";
inline constexpr const char* nowhere_outlined =
    "Nowhere does the form lose a bit beyond what half an ulp in each input would cost";

/// `<form>.<format>.png`: the 99th percentile of lost bits, the colour of the most frequent wrong outcome where most
/// rays have one, outlined where the form is to blame, hatched where too few hits agree. `<form>.<format>.exr`: columns
/// are the first axis's values in rising order, rows the second's from the top, the highest first; the values stand in
/// the attributes.
void write_plane(image::ImageBackend& backend, const std::filesystem::path& folder,
                 const measure::sweep::SweepRequest& request, const std::vector<measure::sweep::SweepStep>& steps,
                 std::size_t row);

/// The picture alone.
void write_plane_picture(image::ImageBackend& backend, const std::filesystem::path& path,
                         const measure::sweep::SweepRequest& request,
                         const std::vector<measure::sweep::SweepStep>& steps, std::size_t row);

}  // namespace lostbits::output::sweep
