// Reads files of named cases: rays and primitives at the extremes of a format, scaled to each format.
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
    /// Throws InputError with a position for anything that is not a file of cases.
    explicit CaseFile(const std::filesystem::path& path);

    /// An answer is right if its decision is right and its error exceeds the envelope by at most this many bits.
    double right_within_bits = 3;
    /// The conventions on touching by which the forms are judged, one after another. An absent convention is each
    /// form's own.
    std::vector<std::optional<intersect::Touching>> conventions{std::nullopt};

    [[nodiscard]] std::size_t size() const { return cases_.size(); }
    [[nodiscard]] const std::string& name(std::size_t i) const { return cases_[i].name; }
    /// Number of rays of the case. Each of its groups has all of them.
    [[nodiscard]] int ray_count(std::size_t i) const { return static_cast<int>(cases_[i].rays.size()); }
    [[nodiscard]] const std::string& case_note(std::size_t i) const { return cases_[i].note; }
    /// The shapes of the primitives of all cases, each once. A case need not have all of these shapes.
    [[nodiscard]] std::vector<Shape> shapes() const;
    [[nodiscard]] bool accepts(Shapes form_shapes) const {
        return form_shapes == Shapes(shapes()).with_transform(has_transform());
    }
    /// True if primitives of cases have transforms.
    [[nodiscard]] bool has_transform() const;
    /// Returns the indices of the cases whose name matches a glob. Throws InputError with did-you-mean and `where` in
    /// front.
    [[nodiscard]] std::vector<std::size_t> cases_matching(const std::string& glob,
                                                          const toml::SourcePosition& where) const;

    /// The rays of a case as numbers of the format, in groups that share their primitives. They may be improper rays:
    /// components may be NaN or infinite, directions zero.
    [[nodiscard]] std::vector<rays::RayGroup> rays(std::size_t i, const FloatFormat& format) const;
    /// The rays of a case at the scale of the format, in binary64, before they are rounded to the format.
    [[nodiscard]] std::vector<rays::RayGroup> unrounded_rays(std::size_t i, const FloatFormat& format) const;

private:
    struct PrimitiveSpec {
        Shape shape;
        std::vector<toml::Quantity> numbers;
        std::vector<toml::Quantity> matrix = {};  ///< matrix of the primitive, row by row; empty: none
        bool is_inverse = false;                  ///< true if the matrix leads from the world to the primitive

        /// The primitive as numbers of the format, with lengths multiplied by 2^length_exponent.
        [[nodiscard]] Primitive<double> primitive_in(const FloatFormat& format, int length_exponent) const;
    };
    struct RaySpec {
        std::vector<toml::Quantity> origin, direction;
        std::vector<toml::Quantity> tmin, tmax;  ///< one quantity each; empty: the range begins at 0, or has no end
    };
    struct Case {
        std::string name, note;
        toml::Exponent length_exponent;     ///< every length is multiplied by two to this power
        toml::Exponent direction_exponent;  ///< the same for every direction
        std::optional<double> zero_sign;    ///< +0 or −0: replaces every zero of a direction
        OpenEnds open_ends = {};            ///< for the ranges of all rays
        bool symmetric = false;  ///< true: ray and primitive are repeated under each of the 48 symmetries of the axes
        std::vector<PrimitiveSpec> primitives;
        std::vector<RaySpec> rays;
    };
    static Case read_case(toml::TableReader& table);
    static PrimitiveSpec read_primitive_spec(toml::TableReader& table, const ShapeRow& shape_row);
    /// Reads the primitives of a case in their order in the file, in which shapes may be mixed.
    static std::vector<PrimitiveSpec> read_primitive_specs(toml::TableReader& case_table);
    /// Reads a ray. `open` is for its range, which must hold a t.
    static RaySpec read_ray_spec(toml::TableReader& table, OpenEnds open);
    void read_conventions(toml::TableReader& file);
    /// Fails if a primitive of the case breaks a limit of its shape.
    static void require_limits(const Case& case_, const toml::TableReader& table);
    /// The rays at the scale of `scale_format`, as numbers of `format`.
    static std::vector<rays::RayGroup> rays(const Case& case_, const FloatFormat& scale_format,
                                            const FloatFormat& format);

    std::vector<Case> cases_;
};

/// Kinds of sweep files, which differ in their tables.
enum class SweepKind { axes, cases, search, edge_search, every_float };
/// Throws InputError for a file of another schema, and for a table whose name is misspelt.
SweepKind read_sweep_kind(const std::filesystem::path& path);

}  // namespace lostbits::scene::sweep
