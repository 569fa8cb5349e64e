// A shader as forms that a device answers.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "intersect/device/device.hpp"
#include "intersect/shader/source.hpp"

namespace lostbits::intersect::shader {

/// A form for each format that the shader is asked for, named `shader.NAME`, or `shader.NAME.KIND` where `name_device`.
/// `arithmetic` tells of that device how it rounds, for the contract's source. InputError with the user's lines for a
/// shader that does not compile; EnvironmentError for doubles where the device has none.
std::vector<doors::ForeignForm> forms_of(const ShaderSource& shader, const std::shared_ptr<device::Device>& on,
                                         bool name_device, const std::string& arithmetic);

/// How many rays one run of the device may answer, of numbers of so many bits.
std::size_t most_rays(const device::DeviceLimits& limits, int bits);

}  // namespace lostbits::intersect::shader
