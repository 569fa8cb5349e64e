// Named cases: rays and solids at the extremes of a format, the same in every format's own measure.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "intersect/info.hpp"
#include "scene/rays/rays.hpp"
#include "scene/sweep/sweep_head.hpp"
#include "scene/toml/quantity.hpp"

namespace lostbits::scene::sweep {

/// A sweep over `[[case]]` tables in place of axes.
class CaseFile : public SweepHead {
public:
    /// InputError with a position for anything that is not a file of cases.
    explicit CaseFile(const std::filesystem::path& path);

    /// An answer within so many bits of the envelope is right, if its decision is.
    double right_within_bits = 3;
    /// By which conventions on touching the forms are judged, one after another; nothing stands for each by its own.
    std::vector<std::optional<intersect::Touching>> conventions{std::nullopt};

    [[nodiscard]] std::size_t size() const { return cases_.size(); }
    [[nodiscard]] const std::string& name(std::size_t i) const { return cases_[i].name; }
    /// How many rays the case has; each of its groups has them all.
    [[nodiscard]] int rays_of(std::size_t i) const { return static_cast<int>(cases_[i].rays.size()); }
    [[nodiscard]] const std::string& note_of(std::size_t i) const { return cases_[i].note; }
    /// Of the solids of all cases, each once; a case need not have them all.
    [[nodiscard]] std::vector<Shape> shapes() const;
    [[nodiscard]] bool meets(Shapes forms) const { return forms == Shapes(shapes()).placed(are_placed()); }
    /// Whether solids of cases stand under matrices.
    [[nodiscard]] bool are_placed() const;
    /// The places of the cases whose name matches a glob; InputError with did-you-mean, `where` in front.
    [[nodiscard]] std::vector<std::size_t> matching(const std::string& glob, const toml::Where& where) const;

    /// The rays of a case as numbers of the format, by groups that share their solids. They need be no proper rays:
    /// components may be NaN or infinite, directions zero.
    [[nodiscard]] std::vector<rays::RayGroup> rays(std::size_t i, const FloatFormat& format) const;
    /// The same numbers at the format's scale before they are rounded to it: as binary64 has them.
    [[nodiscard]] std::vector<rays::RayGroup> rays_before(std::size_t i, const FloatFormat& format) const;

private:
    struct SolidSpec {
        Shape shape;
        std::vector<toml::Quantity> numbers;
        std::vector<toml::Quantity> matrix = {};  ///< that it stands under, row by row; none: it stands under none
        bool is_inverse = false;                  ///< the matrix leads from the world to the solid

        /// As numbers of the format, at that scale.
        [[nodiscard]] Solid<double> in(const FloatFormat& format, int lengths) const;
    };
    struct RaySpec {
        std::vector<toml::Quantity> origin, direction;
        std::vector<toml::Quantity> tmin, tmax;  ///< one, or none: the range begins at 0, has no end
    };
    struct Case {
        std::string name, note;
        toml::Exponent lengths, directions;  ///< every length, every direction is times two to this
        std::optional<double> zeros;         ///< +0 or −0: every zero of a direction is this one
        OpenEnds open = {};                  ///< of the ranges of all rays
        bool symmetric = false;              ///< once under each of the 48 symmetries of the axes, ray and solid alike
        std::vector<SolidSpec> solids;
        std::vector<RaySpec> rays;
    };
    static Case read_case(toml::TableReader& table);
    /// At the scale of the format `of`, as numbers of `format`.
    static std::vector<rays::RayGroup> rays(const Case& c, const FloatFormat& of, const FloatFormat& format);

    std::vector<Case> cases_;
};

/// What a sweep file holds, by its tables.
enum class SweepKind { axes, cases, search, edge_search, every_float };
/// InputError for a file of another schema, and for a table whose name is misspelt.
SweepKind sweep_kind(const std::filesystem::path& path);

}  // namespace lostbits::scene::sweep
