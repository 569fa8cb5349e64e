// Makes forms from a shader, which a device runs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "intersect/device/device.hpp"
#include "intersect/shader/source.hpp"

namespace lostbits::intersect::shader {

/// Makes a form for each format that the source asks for, named `shader.NAME`, or `shader.NAME.KIND` if `name_device`.
/// `arithmetic` describes how the device rounds; it becomes part of the source that the contract states. Throws
/// InputError with the user's lines if the shader does not compile, and EnvironmentError if it needs doubles and the
/// device has none.
std::vector<external::ForeignForm> forms_of(const ShaderSource& shader,
                                            const std::shared_ptr<device::Device>& target_device, bool name_device,
                                            const std::string& arithmetic);

/// Largest number of rays in one run of the device, for numbers of this many bits.
std::size_t max_rays_per_run(const device::DeviceLimits& limits, int bits);

}  // namespace lostbits::intersect::shader
