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

[[noreturn]] void lacking(const std::string& what) { throw EnvironmentError("vulkan: " + what); }

void require(VkResult result, const char* what) {
    if (result == VK_SUCCESS) return;
    if (result == VK_ERROR_DEVICE_LOST) lacking("the device is lost; does the shader run too long?");
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
        lacking("the device has no memory left");
    lacking(std::string("cannot ") + what + " (error " + std::to_string(result) + ")");
}

/// Reads a list that Vulkan returns in two calls: the count, then the entries.
template <class T, class Ask>
std::vector<T> listed(const Ask& ask) {
    std::uint32_t count = 0;
    ask(&count, static_cast<T*>(nullptr));
    std::vector<T> all(count);
    ask(&count, all.data());
    all.resize(count);
    return all;
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
        lacking("no driver works; install one (Debian: mesa-vulkan-drivers, which also computes on the processor)");
    return instance;
}

/// A device, and the family of its first queue that can run compute programs.
struct Found {
    VkPhysicalDevice device = VK_NULL_HANDLE;
    std::uint32_t queue_family = 0;
};

/// The first device with such a queue that is not a processor; if there is none, the first processor.
Found find_device(VkInstance instance) {
    const auto devices =
        listed<VkPhysicalDevice>([&](auto* count, auto* into) { vkEnumeratePhysicalDevices(instance, count, into); });
    std::optional<Found> best;
    for (const VkPhysicalDevice device : devices) {
        const auto families = listed<VkQueueFamilyProperties>(
            [&](auto* count, auto* into) { vkGetPhysicalDeviceQueueFamilyProperties(device, count, into); });
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(device, &properties);
        for (std::uint32_t k = 0; k < families.size(); ++k) {
            if ((families[k].queueFlags & VK_QUEUE_COMPUTE_BIT) == 0) continue;
            if (!best || properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU) {
                const bool first_card = !best || [&] {
                    VkPhysicalDeviceProperties other;
                    vkGetPhysicalDeviceProperties(best->device, &other);
                    return other.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
                }();
                if (first_card) best = Found{device, k};
            }
            break;
        }
    }
    if (!best)
        lacking(
            "no device can run compute programs; install a driver (Debian: mesa-vulkan-drivers, which also computes "
            "on the processor)");
    return *best;
}

/// A buffer that the device and the processor share. It grows to the largest size that was needed so far.
class HostBuffer {
public:
    HostBuffer() = default;
    HostBuffer(const HostBuffer&) = delete;
    HostBuffer& operator=(const HostBuffer&) = delete;

    void hold(VkDevice device, const VkPhysicalDeviceMemoryProperties& kinds, std::size_t bytes) {
        if (bytes <= size_) return;
        if (size_ > 0) {
            vkDestroyBuffer(device, buffer_, nullptr);
            vkFreeMemory(device, memory_, nullptr);
        }
        size_ = 0;
        VkBufferCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
        info.size = bytes;
        info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
        require(vkCreateBuffer(device, &info, nullptr, &buffer_), "create a buffer");
        VkMemoryRequirements needs;
        vkGetBufferMemoryRequirements(device, buffer_, &needs);
        VkMemoryAllocateInfo allocation{};
        allocation.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
        allocation.allocationSize = needs.size;
        constexpr VkMemoryPropertyFlags wanted =
            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        while (allocation.memoryTypeIndex < kinds.memoryTypeCount &&
               ((needs.memoryTypeBits >> allocation.memoryTypeIndex & 1U) == 0 ||
                (kinds.memoryTypes[allocation.memoryTypeIndex].propertyFlags & wanted) != wanted))
            ++allocation.memoryTypeIndex;
        if (allocation.memoryTypeIndex == kinds.memoryTypeCount)
            lacking("the device has no memory that the processor can access");
        require(vkAllocateMemory(device, &allocation, nullptr, &memory_), "allocate memory");
        require(vkBindBufferMemory(device, buffer_, memory_, 0), "bind memory");
        require(vkMapMemory(device, memory_, 0, VK_WHOLE_SIZE, 0, &mapped_), "map memory");
        size_ = bytes;
    }
    [[nodiscard]] void* mapped() const { return mapped_; }
    [[nodiscard]] VkBuffer name() const { return buffer_; }

private:
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    void* mapped_ = nullptr;
    std::size_t size_ = 0;
};

class VkProgram : public Program {
public:
    VkProgram(VkDevice device, VkPipeline pipeline) : device_(device), pipeline_(pipeline) {}
    ~VkProgram() override { vkDestroyPipeline(device_, pipeline_, nullptr); }
    [[nodiscard]] VkPipeline pipeline() const { return pipeline_; }

private:
    VkDevice device_;
    VkPipeline pipeline_;
};

/// Lives until the process ends. So do its handles, which are never destroyed.
class VkComputer : public Device {
public:
    VkComputer() : instance_(make_instance()), found_(find_device(instance_)) {
        VkPhysicalDeviceProperties p;
        vkGetPhysicalDeviceProperties(found_.device, &p);
        vkGetPhysicalDeviceMemoryProperties(found_.device, &memory_kinds_);
        VkPhysicalDeviceFeatures has;
        vkGetPhysicalDeviceFeatures(found_.device, &has);
        VkPhysicalDeviceDriverProperties driver{};
        driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
        VkPhysicalDeviceProperties2 more{};
        more.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
        more.pNext = &driver;
        vkGetPhysicalDeviceProperties2(found_.device, &more);
        description_ = {"vulkan", p.deviceName, "vendor " + std::to_string(p.vendorID),
                        "Vulkan " + std::to_string(VK_API_VERSION_MAJOR(p.apiVersion)) + "." +
                            std::to_string(VK_API_VERSION_MINOR(p.apiVersion)) + " (" + driver.driverInfo + ")",
                        std::string(driver.driverName) + " " + driver.driverInfo};
        limits_ = {.buffer_bytes = p.limits.maxStorageBufferRange,
                   .groups = p.limits.maxComputeWorkGroupCount[0],
                   .doubles = has.shaderFloat64 == VK_TRUE,
                   .glsl = 450};
        make_device(has);
        make_layout();
        make_commands();
    }

    [[nodiscard]] const DeviceDescription& description() const override { return description_; }
    [[nodiscard]] const DeviceLimits& limits() const override { return limits_; }

    [[nodiscard]] std::unique_ptr<Program> compile_here(const std::string& text, Language language) override {
        const std::vector<std::uint32_t> code = spirv_of(text, language);
        VkShaderModuleCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
        info.codeSize = code.size() * sizeof(std::uint32_t);
        info.pCode = code.data();
        VkShaderModule module = VK_NULL_HANDLE;
        require(vkCreateShaderModule(device_, &info, nullptr, &module), "load a program");
        VkComputePipelineCreateInfo pipeline{};
        pipeline.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
        pipeline.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        pipeline.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
        pipeline.stage.module = module;
        pipeline.stage.pName = entry_of(language);
        pipeline.layout = layout_;
        VkPipeline made = VK_NULL_HANDLE;
        const VkResult result = vkCreateComputePipelines(device_, VK_NULL_HANDLE, 1, &pipeline, nullptr, &made);
        vkDestroyShaderModule(device_, module, nullptr);
        require(result, "compile a program");
        return std::make_unique<VkProgram>(device_, made);
    }

    void run_here(Program& program, std::span<const Buffer> buffers, std::size_t groups) override {
        std::array<VkDescriptorBufferInfo, most_buffers> places{};
        std::array<VkWriteDescriptorSet, most_buffers> writes{};
        for (std::size_t k = 0; k < buffers.size(); ++k) {
            buffers_[k].hold(device_, memory_kinds_, buffers[k].bytes.size());
            std::memcpy(buffers_[k].mapped(), buffers[k].bytes.data(), buffers[k].bytes.size());
            places[k] = {buffers_[k].name(), 0, VK_WHOLE_SIZE};
            writes[k].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
            writes[k].dstSet = set_;
            writes[k].dstBinding = static_cast<std::uint32_t>(k);
            writes[k].descriptorCount = 1;
            writes[k].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
            writes[k].pBufferInfo = &places[k];
        }
        vkUpdateDescriptorSets(device_, static_cast<std::uint32_t>(buffers.size()), writes.data(), 0, nullptr);
        submit(static_cast<VkProgram&>(program).pipeline(), static_cast<std::uint32_t>(groups));
        for (std::size_t k = 0; k < buffers.size(); ++k) {
            if (buffers[k].written) std::memcpy(buffers[k].bytes.data(), buffers_[k].mapped(), buffers[k].bytes.size());
        }
    }

private:
    static constexpr std::size_t most_buffers = 7;

    void make_device(const VkPhysicalDeviceFeatures& has) {
        const float priority = 1;
        VkDeviceQueueCreateInfo queue{};
        queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
        queue.queueFamilyIndex = found_.queue_family;
        queue.queueCount = 1;
        queue.pQueuePriorities = &priority;
        VkPhysicalDeviceFeatures wanted{};
        wanted.shaderFloat64 = has.shaderFloat64;
        VkDeviceCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
        info.queueCreateInfoCount = 1;
        info.pQueueCreateInfos = &queue;
        info.pEnabledFeatures = &wanted;
        require(vkCreateDevice(found_.device, &info, nullptr, &device_), "open the device");
        vkGetDeviceQueue(device_, found_.queue_family, 0, &queue_);
    }

    void make_layout() {
        std::array<VkDescriptorSetLayoutBinding, most_buffers> bindings{};
        for (std::size_t k = 0; k < most_buffers; ++k)
            bindings[k] = {static_cast<std::uint32_t>(k), VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
                           VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
        VkDescriptorSetLayoutCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
        info.bindingCount = most_buffers;
        info.pBindings = bindings.data();
        VkDescriptorSetLayout of_set = VK_NULL_HANDLE;
        require(vkCreateDescriptorSetLayout(device_, &info, nullptr, &of_set), "lay out buffers");
        VkPipelineLayoutCreateInfo all{};
        all.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
        all.setLayoutCount = 1;
        all.pSetLayouts = &of_set;
        require(vkCreatePipelineLayout(device_, &all, nullptr, &layout_), "lay out buffers");
        const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, most_buffers};
        VkDescriptorPoolCreateInfo pool{};
        pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
        pool.maxSets = 1;
        pool.poolSizeCount = 1;
        pool.pPoolSizes = &size;
        VkDescriptorPool made = VK_NULL_HANDLE;
        require(vkCreateDescriptorPool(device_, &pool, nullptr, &made), "lay out buffers");
        VkDescriptorSetAllocateInfo one{};
        one.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
        one.descriptorPool = made;
        one.descriptorSetCount = 1;
        one.pSetLayouts = &of_set;
        require(vkAllocateDescriptorSets(device_, &one, &set_), "lay out buffers");
    }

    void make_commands() {
        VkCommandPoolCreateInfo pool{};
        pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
        pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
        pool.queueFamilyIndex = found_.queue_family;
        VkCommandPool made = VK_NULL_HANDLE;
        require(vkCreateCommandPool(device_, &pool, nullptr, &made), "create commands");
        VkCommandBufferAllocateInfo one{};
        one.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
        one.commandPool = made;
        one.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
        one.commandBufferCount = 1;
        require(vkAllocateCommandBuffers(device_, &one, &commands_), "create commands");
        VkFenceCreateInfo fence{};
        fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
        require(vkCreateFence(device_, &fence, nullptr, &done_), "create commands");
    }

    /// Runs the program and waits for its end without a limit. The process that asked has a time limit.
    void submit(VkPipeline pipeline, std::uint32_t groups) {
        VkCommandBufferBeginInfo begin{};
        begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
        require(vkBeginCommandBuffer(commands_, &begin), "create commands");
        vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
        vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set_, 0, nullptr);
        vkCmdDispatch(commands_, groups, 1, 1);
        VkMemoryBarrier seen{};
        seen.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
        seen.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
        seen.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
        vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &seen,
                             0, nullptr, 0, nullptr);
        require(vkEndCommandBuffer(commands_), "create commands");
        VkSubmitInfo work{};
        work.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
        work.commandBufferCount = 1;
        work.pCommandBuffers = &commands_;
        require(vkResetFences(device_, 1, &done_), "run a program");
        require(vkQueueSubmit(queue_, 1, &work, done_), "run a program");
        require(vkWaitForFences(device_, 1, &done_, VK_TRUE, UINT64_MAX), "run a program");
    }

    VkInstance instance_;
    Found found_;
    VkPhysicalDeviceMemoryProperties memory_kinds_{};
    DeviceDescription description_;
    DeviceLimits limits_;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    VkFence done_ = VK_NULL_HANDLE;
    std::array<HostBuffer, most_buffers> buffers_;
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
