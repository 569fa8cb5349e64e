// The Vulkan module: runs compute programs, which glslang compiles to SPIR-V. It is built as `lostbits_vulkan` and
// loaded at run time.
#include <vulkan/vulkan.h>

#include <array>
#include <cstring>
#include <optional>

#include "intersect/device/device.hpp"
#include "intersect/device/module_vulkan_spirv.hpp"

namespace lostbits::intersect::device {
namespace {

[[noreturn]] void fail(const std::string& problem) { throw EnvironmentError("vulkan: " + problem); }

void require_success(VkResult result, const char* action) {
    if (result == VK_SUCCESS) return;
    if (result == VK_ERROR_DEVICE_LOST) fail("the device is lost; does the shader run too long?");
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
        fail("the device has no memory left");
    fail(std::string("cannot ") + action + " (error " + std::to_string(result) + ")");
}

/// Reads a list that Vulkan returns in two calls: the count, then the entries.
template <class T, class Enumerate>
std::vector<T> read_list(const Enumerate& enumerate) {
    std::uint32_t count = 0;
    enumerate(&count, static_cast<T*>(nullptr));
    std::vector<T> list(count);
    enumerate(&count, list.data());
    list.resize(count);
    return list;
}

VkInstance make_instance() {
    const VkApplicationInfo program{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                    .pNext = nullptr,
                                    .pApplicationName = "lostbits",
                                    .applicationVersion = 1,
                                    .pEngineName = nullptr,
                                    .engineVersion = 0,
                                    .apiVersion = VK_API_VERSION_1_1};
    VkInstanceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pApplicationInfo = &program;
    VkInstance instance = VK_NULL_HANDLE;
    if (vkCreateInstance(&info, nullptr, &instance) != VK_SUCCESS)
        fail("no driver works; install one (Debian: mesa-vulkan-drivers, which also computes on the processor)");
    return instance;
}

/// A device, and the index of its first queue family that can run compute programs.
struct SelectedDevice {
    VkPhysicalDevice device = VK_NULL_HANDLE;
    std::uint32_t queue_family = 0;
};

bool is_processor(VkPhysicalDevice device) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device, &properties);
    return properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
}

std::optional<std::uint32_t> find_compute_family(VkPhysicalDevice device) {
    const auto families = read_list<VkQueueFamilyProperties>(
        [&](auto* count, auto* entries) { vkGetPhysicalDeviceQueueFamilyProperties(device, count, entries); });
    for (std::uint32_t k = 0; k < families.size(); ++k)
        if ((families[k].queueFlags & VK_QUEUE_COMPUTE_BIT) != 0) return k;
    return std::nullopt;
}

/// Finds the first device with such a queue family that is not a processor; if every one is a processor, the first
/// processor.
SelectedDevice find_device(VkInstance instance) {
    const auto devices = read_list<VkPhysicalDevice>(
        [&](auto* count, auto* entries) { vkEnumeratePhysicalDevices(instance, count, entries); });
    std::optional<SelectedDevice> best;
    for (const VkPhysicalDevice device : devices) {
        const std::optional<std::uint32_t> family = find_compute_family(device);
        if (!family) continue;
        if (!best || (is_processor(best->device) && !is_processor(device))) best = SelectedDevice{device, *family};
    }
    if (!best)
        fail(
            "no device can run compute programs; install a driver (Debian: mesa-vulkan-drivers, which also computes "
            "on the processor)");
    return *best;
}

/// Finds the first of the allowed kinds of memory that the processor can access without flushing it. Bit k of
/// `allowed_kinds` allows kind k.
std::uint32_t find_host_memory(const VkPhysicalDeviceMemoryProperties& memory_kinds, std::uint32_t allowed_kinds) {
    constexpr VkMemoryPropertyFlags required_flags =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    for (std::uint32_t k = 0; k < memory_kinds.memoryTypeCount; ++k) {
        const bool is_allowed = (allowed_kinds >> k & 1U) != 0;
        if (is_allowed && (memory_kinds.memoryTypes[k].propertyFlags & required_flags) == required_flags) return k;
    }
    fail("the device has no memory that the processor can access");
}

/// A buffer that the device and the processor share. It grows to the largest size needed so far.
class HostBuffer {
public:
    HostBuffer() = default;
    HostBuffer(const HostBuffer&) = delete;
    HostBuffer& operator=(const HostBuffer&) = delete;

    void grow_to(VkDevice device, const VkPhysicalDeviceMemoryProperties& memory_kinds, std::size_t byte_count) {
        if (byte_count <= size_) return;
        if (size_ > 0) {
            vkDestroyBuffer(device, buffer_, nullptr);
            vkFreeMemory(device, memory_, nullptr);
        }
        size_ = 0;

        VkBufferCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
        info.size = byte_count;
        info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
        require_success(vkCreateBuffer(device, &info, nullptr, &buffer_), "create a buffer");

        // The memory may have to be larger than the buffer.
        VkMemoryRequirements requirements;
        vkGetBufferMemoryRequirements(device, buffer_, &requirements);
        VkMemoryAllocateInfo allocation{};
        allocation.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
        allocation.allocationSize = requirements.size;
        allocation.memoryTypeIndex = find_host_memory(memory_kinds, requirements.memoryTypeBits);
        require_success(vkAllocateMemory(device, &allocation, nullptr, &memory_), "allocate memory");

        // The memory stays mapped until it is freed.
        require_success(vkBindBufferMemory(device, buffer_, memory_, 0), "bind memory");
        require_success(vkMapMemory(device, memory_, 0, VK_WHOLE_SIZE, 0, &mapped_), "map memory");
        size_ = byte_count;
    }
    [[nodiscard]] void* mapped() const { return mapped_; }
    [[nodiscard]] VkBuffer name() const { return buffer_; }

private:
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    void* mapped_ = nullptr;
    std::size_t size_ = 0;
};

class VkProgram : public DeviceProgram {
public:
    VkProgram(VkDevice device, VkPipeline pipeline) : device_(device), pipeline_(pipeline) {}
    ~VkProgram() override { vkDestroyPipeline(device_, pipeline_, nullptr); }
    [[nodiscard]] VkPipeline pipeline() const { return pipeline_; }

private:
    VkDevice device_;
    VkPipeline pipeline_;
};

/// The device lives until the process ends. So do its handles, which are never destroyed.
class VkComputer : public Device {
public:
    VkComputer() : instance_(make_instance()), selected_(find_device(instance_)) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(selected_.device, &properties);
        vkGetPhysicalDeviceMemoryProperties(selected_.device, &memory_kinds_);
        VkPhysicalDeviceFeatures available_features;
        vkGetPhysicalDeviceFeatures(selected_.device, &available_features);

        // The name and version of the driver are in an extension of the properties.
        VkPhysicalDeviceDriverProperties driver{};
        driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
        VkPhysicalDeviceProperties2 extended_properties{};
        extended_properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
        extended_properties.pNext = &driver;
        vkGetPhysicalDeviceProperties2(selected_.device, &extended_properties);

        description_ = {"vulkan", properties.deviceName, "vendor " + std::to_string(properties.vendorID),
                        "Vulkan " + std::to_string(VK_API_VERSION_MAJOR(properties.apiVersion)) + "." +
                            std::to_string(VK_API_VERSION_MINOR(properties.apiVersion)) + " (" + driver.driverInfo +
                            ")",
                        std::string(driver.driverName) + " " + driver.driverInfo};
        limits_ = {.max_buffer_bytes = properties.limits.maxStorageBufferRange,
                   .max_groups = properties.limits.maxComputeWorkGroupCount[0],
                   .has_doubles = available_features.shaderFloat64 == VK_TRUE,
                   .glsl = 450};

        make_device(available_features);
        make_layout();
        make_commands();
    }

    [[nodiscard]] const DeviceDescription& description() const override { return description_; }
    [[nodiscard]] const DeviceLimits& limits() const override { return limits_; }

    [[nodiscard]] std::unique_ptr<DeviceProgram> compile_program(const std::string& text, Language language) override {
        const std::vector<std::uint32_t> code = compile_to_spirv(text, language);
        VkShaderModuleCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
        info.codeSize = code.size() * sizeof(std::uint32_t);
        info.pCode = code.data();
        VkShaderModule module = VK_NULL_HANDLE;
        require_success(vkCreateShaderModule(device_, &info, nullptr, &module), "load a program");

        VkComputePipelineCreateInfo pipeline{};
        pipeline.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
        pipeline.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        pipeline.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
        pipeline.stage.module = module;
        pipeline.stage.pName = entry_of(language);
        pipeline.layout = layout_;

        // The pipeline keeps what it needs of the module.
        VkPipeline pipeline_handle = VK_NULL_HANDLE;
        const VkResult result =
            vkCreateComputePipelines(device_, VK_NULL_HANDLE, 1, &pipeline, nullptr, &pipeline_handle);
        vkDestroyShaderModule(device_, module, nullptr);
        require_success(result, "compile a program");
        return std::make_unique<VkProgram>(device_, pipeline_handle);
    }

    void run_program(DeviceProgram& program, std::span<const DeviceBuffer> buffers, std::size_t group_count) override {
        copy_to_device(buffers);
        record_commands(static_cast<VkProgram&>(program).pipeline(), static_cast<std::uint32_t>(group_count));
        submit();
        for (std::size_t k = 0; k < buffers.size(); ++k) {
            if (buffers[k].is_written)
                std::memcpy(buffers[k].bytes.data(), buffers_[k].mapped(), buffers[k].bytes.size());
        }
    }

private:
    static constexpr std::size_t max_buffers = 7;

    /// Copies the buffers to memory that the device can access, and binds them to the bindings of the program.
    void copy_to_device(std::span<const DeviceBuffer> buffers) {
        std::array<VkDescriptorBufferInfo, max_buffers> buffer_infos{};
        std::array<VkWriteDescriptorSet, max_buffers> writes{};
        for (std::size_t k = 0; k < buffers.size(); ++k) {
            buffers_[k].grow_to(device_, memory_kinds_, buffers[k].bytes.size());
            std::memcpy(buffers_[k].mapped(), buffers[k].bytes.data(), buffers[k].bytes.size());

            buffer_infos[k] = {buffers_[k].name(), 0, VK_WHOLE_SIZE};
            writes[k].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
            writes[k].dstSet = set_;
            writes[k].dstBinding = static_cast<std::uint32_t>(k);
            writes[k].descriptorCount = 1;
            writes[k].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
            writes[k].pBufferInfo = &buffer_infos[k];
        }
        vkUpdateDescriptorSets(device_, static_cast<std::uint32_t>(buffers.size()), writes.data(), 0, nullptr);
    }

    void make_device(const VkPhysicalDeviceFeatures& available_features) {
        const float priority = 1;
        VkDeviceQueueCreateInfo queue{};
        queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
        queue.queueFamilyIndex = selected_.queue_family;
        queue.queueCount = 1;
        queue.pQueuePriorities = &priority;

        VkPhysicalDeviceFeatures enabled_features{};
        enabled_features.shaderFloat64 = available_features.shaderFloat64;

        VkDeviceCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
        info.queueCreateInfoCount = 1;
        info.pQueueCreateInfos = &queue;
        info.pEnabledFeatures = &enabled_features;
        require_success(vkCreateDevice(selected_.device, &info, nullptr, &device_), "open the device");
        vkGetDeviceQueue(device_, selected_.queue_family, 0, &queue_);
    }

    void make_layout() {
        const VkDescriptorSetLayout set_layout = make_set_layout();
        VkPipelineLayoutCreateInfo pipeline_layout{};
        pipeline_layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
        pipeline_layout.setLayoutCount = 1;
        pipeline_layout.pSetLayouts = &set_layout;
        require_success(vkCreatePipelineLayout(device_, &pipeline_layout, nullptr, &layout_), "lay out buffers");
        allocate_set(set_layout);
    }

    /// Makes a layout with `max_buffers` buffers at the bindings 0, 1, …
    VkDescriptorSetLayout make_set_layout() {
        std::array<VkDescriptorSetLayoutBinding, max_buffers> bindings{};
        for (std::size_t k = 0; k < max_buffers; ++k)
            bindings[k] = {static_cast<std::uint32_t>(k), VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
                           VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
        VkDescriptorSetLayoutCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
        info.bindingCount = max_buffers;
        info.pBindings = bindings.data();
        VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
        require_success(vkCreateDescriptorSetLayout(device_, &info, nullptr, &set_layout), "lay out buffers");
        return set_layout;
    }

    void allocate_set(VkDescriptorSetLayout set_layout) {
        const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, max_buffers};
        VkDescriptorPoolCreateInfo pool{};
        pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
        pool.maxSets = 1;
        pool.poolSizeCount = 1;
        pool.pPoolSizes = &size;
        VkDescriptorPool descriptor_pool = VK_NULL_HANDLE;
        require_success(vkCreateDescriptorPool(device_, &pool, nullptr, &descriptor_pool), "lay out buffers");

        VkDescriptorSetAllocateInfo allocation{};
        allocation.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
        allocation.descriptorPool = descriptor_pool;
        allocation.descriptorSetCount = 1;
        allocation.pSetLayouts = &set_layout;
        require_success(vkAllocateDescriptorSets(device_, &allocation, &set_), "lay out buffers");
    }

    void make_commands() {
        VkCommandPoolCreateInfo pool{};
        pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
        pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
        pool.queueFamilyIndex = selected_.queue_family;
        VkCommandPool command_pool = VK_NULL_HANDLE;
        require_success(vkCreateCommandPool(device_, &pool, nullptr, &command_pool), "create commands");

        VkCommandBufferAllocateInfo allocation{};
        allocation.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
        allocation.commandPool = command_pool;
        allocation.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
        allocation.commandBufferCount = 1;
        require_success(vkAllocateCommandBuffers(device_, &allocation, &commands_), "create commands");

        VkFenceCreateInfo fence{};
        fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
        require_success(vkCreateFence(device_, &fence, nullptr, &fence_), "create commands");
    }

    /// Records a run of the program. The barrier makes its results visible to the processor.
    void record_commands(VkPipeline pipeline, std::uint32_t group_count) {
        VkCommandBufferBeginInfo begin{};
        begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
        require_success(vkBeginCommandBuffer(commands_, &begin), "create commands");
        vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
        vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set_, 0, nullptr);
        vkCmdDispatch(commands_, group_count, 1, 1);

        VkMemoryBarrier barrier{};
        barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
        barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
        barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
        vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                             &barrier, 0, nullptr, 0, nullptr);
        require_success(vkEndCommandBuffer(commands_), "create commands");
    }

    /// Runs the commands and waits for their end without a limit, since the process that started this process has a
    /// time limit.
    void submit() {
        VkSubmitInfo submission{};
        submission.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
        submission.commandBufferCount = 1;
        submission.pCommandBuffers = &commands_;
        require_success(vkResetFences(device_, 1, &fence_), "run a program");
        require_success(vkQueueSubmit(queue_, 1, &submission, fence_), "run a program");
        require_success(vkWaitForFences(device_, 1, &fence_, VK_TRUE, UINT64_MAX), "run a program");
    }

    VkInstance instance_;
    SelectedDevice selected_;
    VkPhysicalDeviceMemoryProperties memory_kinds_{};
    DeviceDescription description_;
    DeviceLimits limits_;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
    std::array<HostBuffer, max_buffers> buffers_;
};

}  // namespace
}  // namespace lostbits::intersect::device

extern "C" {
__attribute__((visibility("default"))) extern const int lostbits_device_build =
    lostbits::intersect::device::device_build;
__attribute__((visibility("default"))) lostbits::intersect::device::Device* lostbits_open_device() {
    return new lostbits::intersect::device::VkComputer();
}
}
