// An exhaustive sweep: a number of a ray or of its primitive takes every float of a range, or every float there is.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "intersect/info.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"
#include "scene/rays/primitive_list.hpp"
#include "scene/rays/rays.hpp"
#include "scene/sweep/float_order.hpp"
#include "scene/sweep/sweep_head.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::sweep {

/// A sweep file with one `[[axis]]` (or `[axis]`), `[[ray]]` tables, and a primitive (`[sphere]`, say) or a scene
/// whose mesh the rays cross. All numbers are binary32.
class ExhaustiveFile : public SweepHead {
public:
    /// Throws InputError with a position for anything that is not such a sweep. A scene is looked up in `data_dir`.
    ExhaustiveFile(const std::filesystem::path& path, const std::filesystem::path& data_dir,
                   intersect::process::StopToken stop = {});

    /// The convention on touching by which all forms are judged; absent: each form's own.
    std::optional<intersect::Touching> convention;

    AxisName axis;
    /// Indices of the numbers that the axis sets, all to the same float. `ray_indices`: 0 to 5 for origin x, y, z and
    /// direction x, y, z. `primitive_indices`: indices into the numbers of the primitive.
    std::vector<std::size_t> ray_indices, primitive_indices;

    struct NamedRay {
        std::string name;
        Ray<float> ray;
        float tmax = std::numeric_limits<float>::infinity();  ///< where the ray ends (boxes only)
    };
    std::vector<NamedRay> rays;
    Primitive<float> primitive;  ///< any triangle, in a sweep across a mesh
    /// The triangles of the scene, whose numbers are fixed; null if there is one primitive.
    std::shared_ptr<const rays::StoredMesh> mesh;
    std::optional<file::Scene> scene;

    /// The ranges to try, in order: from `from` to `to`, or from each zero outwards over all floats of its sign.
    [[nodiscard]] const std::vector<FloatRange>& ranges() const { return ranges_; }
    [[nodiscard]] std::uint64_t float_count() const;
    /// Narrows the sweep to the floats from `from` to `to`. Throws InputError with `where` in front unless both are
    /// floats of the file's ranges.
    void narrow(const Real& from, const Real& to, const toml::SourcePosition& where);

    [[nodiscard]] bool accepts(Shapes form_shapes) const { return form_shapes == primitive.shape; }
    /// A ray, its primitive, and both as a group, with the axis at a float.
    [[nodiscard]] Ray<float> ray_at(std::size_t ray, float value) const;
    [[nodiscard]] Primitive<float> primitive_at(float value) const;
    [[nodiscard]] rays::RayGroup group_at(std::size_t ray, float value) const {
        return group_of_floats(ray, {index_of(value), index_of(value)});
    }
    /// Group of one ray with the axis at each of several floats. If the axis sets numbers of the primitive, each ray
    /// has a primitive of its own.
    [[nodiscard]] rays::RayGroup group_of_floats(std::size_t ray, const FloatRange& floats) const;

private:
    void read_primitive(toml::TableReader& file);
    void read_scene(toml::TableReader& file, const std::filesystem::path& data_dir, intersect::process::StopToken stop);
    void read_ray(toml::TableReader& table);
    void read_axis(toml::TableReader& table);
    void read_path(const std::string& path, const toml::TableReader& table);
    void read_range(toml::TableReader& table);
    void require_valid_primitives(toml::TableReader& file, const toml::TableReader& axis_table) const;

    std::vector<FloatRange> ranges_;
};

/// Returns x if it is representable in binary32; otherwise nothing.
std::optional<float> to_exact_float(const Real& x);

}  // namespace lostbits::scene::sweep
