// The rays of a camera as each format makes them from the numbers that it stores, and what they ideally are.
#pragma once

#include <deque>
#include <mutex>
#include <utility>

#include "number/real.hpp"
#include "scene/camera/makers.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::scene::rays {

/// The numbers of a scene's camera, in exact numbers: matrices are composed and inverted there.
camera::CameraNumbers<Real> camera_numbers(const file::Scene& scene);

/// A ray with every operation that made it: the tape's inputs are what of the camera's numbers the way takes.
struct RecordedRay {
    Tape tape;
    std::array<NodeId, 6> ray;
    std::vector<std::string> names;  ///< of the inputs

    /// Puts this in front of a form's tape, in the place of that one's ray.
    void put_before(Tape& form) const;
    /// The same if it is the same ray to the bit: a form for unit directions gets another.
    bool lead(Tape& form) const;
};

class MadeRays {
public:
    /// Of a scene whose camera says who makes its rays (`file::with_rays`).
    explicit MadeRays(const file::Scene& scene);
    /// The exact rays of the pixels of some rows, of length one: from the eye, or from where each meets the near plane.
    [[nodiscard]] BasicRayBlock<Real> ideal(int y0, int y1) const;
    /// What a format makes of them; none of the numbers is rounded more than once before the first operation.
    [[nodiscard]] RayBlock in(const FloatFormat& format, int y0, int y1) const;
    [[nodiscard]] RecordedRay record(const Format& format, camera::Place at) const;
    [[nodiscard]] const CameraFrame<Real>& frame() const { return frame_; }

private:
    /// Rounded once for each format.
    [[nodiscard]] const camera::CameraNumbers<double>& stored(const FloatFormat& format) const;
    template <class T>
    RayBlock made(camera::MakeIn<T> make, const FloatFormat& format, int y0, int y1) const;

    const camera::Maker* by_;
    CameraFrame<Real> frame_;
    camera::CameraNumbers<Real> numbers_;
    mutable std::mutex storing_;
    mutable std::deque<std::pair<FloatFormat, camera::CameraNumbers<double>>> stored_;
};

}  // namespace lostbits::scene::rays
