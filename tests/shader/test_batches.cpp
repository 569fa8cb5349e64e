// Batches and the limits of a device, on a fake device.
#include <cstring>
#include <memory>
#include <vector>

#include "catch.hpp"
#include "intersect/shader/forms.hpp"
#include "intersect/shader/kernel.hpp"

namespace test_batches {

using namespace lostbits::intersect;
using namespace lostbits::intersect::shader;
using device::Device;
using device::DeviceBuffer;
using device::DeviceDescription;
using device::DeviceLimits;

namespace {

/// Answers each ray with its origin's x plus its primitive's last number, and counts the requests.
class Echo : public Device {
public:
    explicit Echo(DeviceLimits limits) : limits_(limits) {}
    [[nodiscard]] const DeviceDescription& description() const override { return description_; }
    [[nodiscard]] const DeviceLimits& limits() const override { return limits_; }
    [[nodiscard]] std::unique_ptr<device::DeviceProgram> compile_program(const std::string&,
                                                                         device::Language) override {
        return std::make_unique<device::DeviceProgram>();
    }
    void run_program(device::DeviceProgram&, std::span<const DeviceBuffer> buffers, std::size_t group_count) override {
        KernelHead head;
        std::memcpy(&head, buffers[BufferBinding::head].bytes.data(), sizeof head);
        for (const DeviceBuffer& b : buffers) {
            REQUIRE_FALSE(b.bytes.empty());
            REQUIRE(b.bytes.size() <= limits_.max_buffer_bytes);
        }
        REQUIRE(group_count <= limits_.max_groups);
        REQUIRE(group_count * device::group_size >= head.ray_count);
        const auto* const rays = reinterpret_cast<const float*>(buffers[BufferBinding::rays].bytes.data());
        const auto* const primitives = reinterpret_cast<const float*>(buffers[BufferBinding::primitives].bytes.data());
        auto* const answers = reinterpret_cast<float*>(buffers[BufferBinding::answers].bytes.data());
        for (std::uint32_t i = 0; i < head.ray_count; ++i)
            answers[2 * i] = answers[2 * i + 1] = rays[6 * i] + primitives[head.stride * i + 3];
        auto* const hits = reinterpret_cast<std::uint32_t*>(buffers[BufferBinding::hits].bytes.data());
        std::fill_n(hits, loses ? head.ray_count - 1 : head.ray_count, 1U);
        ++runs;
    }
    int runs = 0;
    bool loses = false;  ///< the last ray of each run

private:
    DeviceDescription description_{"echo", "Echo", "-", "1", "-"};
    DeviceLimits limits_;
};

ShaderSource some_shader() {
    ShaderSource shader;
    shader.path = "a.glsl";
    shader.text = "float f(vec3 ro, vec3 rd, vec4 s) { return 1.0; }";
    shader.signature = *read_signature(find_functions(code_tokens(split_into_tokens(shader.text))).front());
    shader.contract.name = "shader.a";
    return shader;
}

}  // namespace

TEST_CASE("shader: a batch larger than the device allows is split, and each ray keeps its own primitive", "[shader]") {
    constexpr std::size_t n = 1000;
    std::vector<float> rays(6 * n), primitives(4 * n), near_far(2 * n);
    std::vector<unsigned char> hit(n, 7);
    for (std::size_t i = 0; i < n; ++i) {
        rays[6 * i] = static_cast<float>(i);
        primitives[4 * i + 3] = i % 2 == 0 ? 1 : -2000;
    }
    for (const std::size_t stride : {std::size_t(0), std::size_t(4)}) {
        const auto echo = std::make_shared<Echo>(DeviceLimits{.max_buffer_bytes = 24 * 100, .max_groups = 1});
        const auto forms = forms_of(some_shader(), echo, true, "words");
        REQUIRE(forms.size() == 1);
        CHECK(forms[0].contract.name == "shader.a.echo");
        CHECK(forms[0].contract.source == "a.glsl:1 on words");
        forms[0].answer(
            {n, rays.data(), nullptr, primitives.data(), stride, near_far.data(), hit.data(), nullptr, nullptr});
        CHECK(echo->runs == 16);  // of 64 rays, since one group is all that it takes
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const float right = static_cast<float>(i) + (stride == 0 || i % 2 == 0 ? 1.0F : -2000.0F);
            wrong += near_far[2 * i] != right || hit[i] != (right >= 0);
        }
        CHECK(wrong == 0);
    }
}

TEST_CASE("shader: a ray that the device does not answer is an error, not a miss", "[shader]") {
    const auto echo = std::make_shared<Echo>(DeviceLimits{.max_buffer_bytes = 1 << 20, .max_groups = 100});
    echo->loses = true;
    const std::vector<float> rays(6 * 100), primitives(4);
    std::vector<float> near_far(2 * 100);
    std::vector<unsigned char> hit(100);
    const auto forms = forms_of(some_shader(), echo, false, "");
    CHECK_THROWS_WITH(forms[0].answer({100, rays.data(), nullptr, primitives.data(), 0, near_far.data(), hit.data(),
                                       nullptr, nullptr}),
                      "echo: the device is lost: it wrote no answer; does the shader run too long?");
}

TEST_CASE("shader: doubles are refused or left out on a device that lacks them", "[shader]") {
    const auto without = std::make_shared<Echo>(DeviceLimits{.max_buffer_bytes = 1 << 20, .max_groups = 100});
    ShaderSource shader = some_shader();
    shader.f64 = true;
    CHECK(forms_of(shader, without, false, "").size() == 1);
    CHECK(forms_of(shader, without, false, "")[0].contract.name == "shader.a");
    shader.f32 = false;
    CHECK_THROWS_AS(forms_of(shader, without, false, ""), lostbits::EnvironmentError);
    CHECK(max_rays_per_run({.max_buffer_bytes = 4800, .max_groups = 1000}, 64) == 100);
    CHECK(max_rays_per_run({.max_buffer_bytes = 1, .max_groups = 1}, 32) == 1);
}

}  // namespace test_batches
