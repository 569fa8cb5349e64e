// Makes the rays of a camera as each format computes them from the camera's stored numbers, and the ideal rays.
#pragma once

#include <deque>
#include <mutex>
#include <utility>

#include "number/real.hpp"
#include "scene/camera/ray_generators.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::scene::rays {

/// The numbers of a scene's camera in exact numbers, in which matrices are composed and inverted.
camera::CameraNumbers<Real> compute_camera_numbers(const file::Scene& scene);

/// A ray with all operations that compute it. The inputs of the tape are the camera's numbers that the ray generator
/// uses.
struct RecordedRay {
    Tape tape;
    std::array<NodeId, 6> ray;
    std::vector<std::string> names;  ///< names of the inputs

    /// Puts this tape in front of a form's tape, in place of the form's ray.
    void prepend_to(Tape& form) const;
    /// Does the same if both rays are the same to the bit; otherwise returns false. A form for unit directions gets
    /// another ray.
    bool try_prepend_to(Tape& form) const;
};

class GeneratedRays {
public:
    /// Takes a scene whose camera has a ray generator (`file::with_ray_generator`).
    explicit GeneratedRays(const file::Scene& scene);
    /// Exact rays of the pixels of rows [y0, y1), with length one: from the eye, or from the point where the ray meets
    /// the near plane.
    [[nodiscard]] BasicRayBlock<Real> make_ideal_rays(int y0, int y1) const;
    /// Rays of rows [y0, y1) as a format computes them. No number is rounded more than once before the first operation.
    [[nodiscard]] RayBlock make_rounded_rays(const FloatFormat& format, int y0, int y1) const;
    [[nodiscard]] RecordedRay record_ray(const Format& format, camera::PixelCoordinates at) const;
    [[nodiscard]] const CameraFrame<Real>& frame() const { return frame_; }

private:
    /// Returns the camera's numbers, each rounded once to the format.
    [[nodiscard]] const camera::CameraNumbers<double>& stored_numbers(const FloatFormat& format) const;
    template <class T>
    RayBlock generate(camera::MakeRays<T> make_rays, const FloatFormat& format, int y0, int y1) const;

    const camera::RayGenerator* generator_;
    CameraFrame<Real> frame_;
    camera::CameraNumbers<Real> numbers_;
    mutable std::mutex stored_mutex_;
    mutable std::deque<std::pair<FloatFormat, camera::CameraNumbers<double>>> stored_;
};

}  // namespace lostbits::scene::rays
