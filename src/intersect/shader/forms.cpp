#include "intersect/shader/forms.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>

#include "intersect/shader/compiler_log.hpp"
#include "intersect/shader/kernel.hpp"

namespace lostbits::intersect::shader {

using device::CompileError;
using device::Device;
using device::DeviceBuffer;
using device::DeviceDescription;
using device::DeviceLimits;
using device::DeviceProgram;
using device::group_size;

namespace {

/// One compiled function, with the buffers for a batch.
class Runner {
public:
    Runner(std::shared_ptr<Device> target_device, std::shared_ptr<DeviceProgram> program, const ShaderSource& shader)
        : device_(std::move(target_device)),
          program_(std::move(program)),
          shape_(shader.signature.shape),
          answers_(shader.signature.answers),
          miss_sentinel_(shader.miss_sentinel) {}

    template <class S>
    void answer(const lb_batch& batch) {
        const std::size_t max_rays = max_rays_per_run(device_->limits(), 8 * sizeof(S));
        for (std::size_t begin = 0; begin < batch.size; begin += max_rays)
            answer_part<S>(batch, begin, std::min(max_rays, batch.size - begin));
    }

private:
    static constexpr std::uint32_t unwritten = 2;

    template <class S>
    static std::span<std::byte> bytes_at(const void* column, std::size_t first, std::size_t count) {
        const auto* const begin = static_cast<const S*>(column) + first;
        // Read-only buffers are never written through this pointer.
        return {reinterpret_cast<std::byte*>(const_cast<S*>(begin)), count * sizeof(S)};
    }

    template <class S>
    void answer_part(const lb_batch& batch, std::size_t begin, std::size_t n) {
        const std::size_t number_count = row_of(shape_).number_count;
        KernelHead kernel_head{static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(batch.primitive_stride),
                               batch.ends != nullptr ? 1U : 0U, batch.starts != nullptr ? 1U : 0U};
        hits_.assign(n, unwritten);

        // Buffers in the order of `BufferBinding`. A column that is absent has a buffer of one number.
        const bool has_own_primitives = batch.primitive_stride != 0;
        S* const near_far = static_cast<S*>(batch.near_far) + 2 * begin;
        const S no_number = 0;
        const std::array<DeviceBuffer, BufferBinding::binding_count> buffers{{
            {std::as_writable_bytes(std::span(&kernel_head, 1))},
            {bytes_at<S>(batch.rays, 6 * begin, 6 * n)},
            {batch.ends != nullptr ? bytes_at<S>(batch.ends, begin, n) : bytes_at<S>(&no_number, 0, 1)},
            {bytes_at<S>(batch.primitives, has_own_primitives ? begin * batch.primitive_stride : 0,
                         has_own_primitives ? n * batch.primitive_stride : number_count)},
            {std::as_writable_bytes(std::span(near_far, 2 * n)), true},
            {std::as_writable_bytes(std::span(hits_)), true},
            {batch.starts != nullptr ? bytes_at<S>(batch.starts, begin, n) : bytes_at<S>(&no_number, 0, 1)},
        }};
        device_->run(*program_, buffers, (n + group_size - 1) / group_size);

        // A driver may lose its device without an error. Every ray of a run writes an entry here, so an unwritten entry
        // reveals the loss.
        if (std::ranges::find(hits_, unwritten) != hits_.end())
            throw EnvironmentError(device_->description().kind +
                                   ": the device is lost: it wrote no answer; does the shader run too long?");

        // A function that returns only numbers reports a miss by a number.
        const bool returns_hit = answers_ != Signature::Answers::t && answers_ != Signature::Answers::near_far;
        for (std::size_t i = 0; i < n; ++i)
            batch.hit[begin + i] = returns_hit ? hits_[i] != 0
                                               : !miss_sentinel_.means_miss(static_cast<double>(near_far[2 * i]),
                                                                            static_cast<double>(near_far[2 * i + 1]));
    }

    std::shared_ptr<Device> device_;
    std::shared_ptr<DeviceProgram> program_;
    Shape shape_;
    Signature::Answers answers_;
    MissSentinel miss_sentinel_;
    std::vector<std::uint32_t> hits_;
};

std::shared_ptr<DeviceProgram> compile(const ShaderSource& shader, Device& target_device, int bits) {
    try {
        return target_device.compile(write_program_text(shader, bits, target_device.limits().glsl),
                                     shader.is_hlsl ? device::Language::hlsl : device::Language::glsl);
    } catch (const CompileError& error) {
        const bool is_rewritten = shader.signature.is_double != (bits == 64);
        throw InputError(errors_of(error.what(), shader) +
                         (is_rewritten
                              ? "\n(the file was rewritten for " + std::string(bits == 64 ? "doubles" : "floats") +
                                    ", as format= asks; some functions do not exist for doubles)"
                              : ""));
    }
}

}  // namespace

std::size_t max_rays_per_run(const DeviceLimits& limits, int bits) {
    const std::size_t by_buffer = limits.max_buffer_bytes / (6 * static_cast<std::size_t>(bits) / 8);
    return std::max<std::size_t>(1, std::min(by_buffer, limits.max_groups * group_size));
}

std::vector<external::ForeignForm> forms_of(const ShaderSource& shader, const std::shared_ptr<Device>& target_device,
                                            bool name_device, const std::string& arithmetic) {
    const DeviceDescription& description = target_device->description();
    if (shader.f64 && !target_device->limits().has_doubles && !shader.f32)
        throw EnvironmentError(shader.path + ": " + description.renderer +
                               " has no doubles in shaders; write format=f32, or try another --device");
    std::vector<external::ForeignForm> forms;
    for (const int bits : {32, 64}) {
        if (bits == 32 ? !shader.f32 : !shader.f64 || !target_device->limits().has_doubles) continue;
        external::ForeignForm form{shader.contract, "--shader " + shader.path, {}};
        form.contract.bits = bits;
        if (name_device) form.contract.name += "." + description.kind;
        form.contract.source = std::filesystem::path(shader.path).filename().string() + ":" +
                               std::to_string(shader.signature.function.line) + " on " + arithmetic;
        form.contract.source.resize(std::min<std::size_t>(form.contract.source.size(), 400));
        const auto runner = std::make_shared<Runner>(target_device, compile(shader, *target_device, bits), shader);
        form.answer = [runner, bits](const lb_batch& batch) {
            bits == 32 ? runner->answer<float>(batch) : runner->answer<double>(batch);
        };
        forms.push_back(std::move(form));
    }
    return forms;
}

}  // namespace lostbits::intersect::shader
