// Finds and loads the image module.
#include <dlfcn.h>

#include <cstring>
#include <mutex>
#include <stdexcept>
#include <system_error>

#include "intersect/device/temporary_folder.hpp"
#include "intersect/process/floating_point.hpp"
#include "intersect/process/process_state.hpp"
#include "number/error.hpp"
#include "output/file/result_folder.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::image {
namespace {

namespace fs = std::filesystem;

constexpr const char* module_name = "lostbits_image.so";

fs::path find_module() {
    if (const char* configured_path = intersect::process::own_environment("LOSTBITS_IMAGE_MODULE");
        configured_path != nullptr && *configured_path != '\0')
        return configured_path;
    std::error_code error;
    const fs::path program_folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    std::string tried_paths;
    for (const fs::path& folder : {program_folder, program_folder / "../lib/lostbits", program_folder / "src/output"}) {
        const fs::path candidate = folder / module_name;
        if (fs::exists(candidate, error)) return candidate;
        tried_paths += "\n  " + candidate.lexically_normal().string();
    }
    throw EnvironmentError(
        "cannot write images: the image module is missing; build the target `lostbits_image` (it needs "
        "libopenimageio-dev and libcairo2-dev) or set LOSTBITS_IMAGE_MODULE to its path. Looked for it at:" +
        tried_paths);
}

[[noreturn]] void fail_cannot_load(const fs::path& path, const char* reason) {
    if (reason != nullptr && intersect::device::lacks_memory(reason))
        throw EnvironmentError(path.string() + ": cannot load the image module: " + reason +
                               "; the module and its libraries take 500 MB of address space: raise `ulimit -v`");
    throw EnvironmentError(path.string() +
                           ": cannot load the image module: " + (reason != nullptr ? reason : "unknown") +
                           "; install OpenImageIO and Cairo (Debian: libopenimageio2.4, libcairo2) and rebuild the "
                           "target `lostbits_image`");
}

[[noreturn]] void fail_wrong_module(const fs::path& path, const char* reason) {
    throw EnvironmentError(path.string() + ": " + reason + "; rebuild the target `lostbits_image`");
}

ImageBackend& load_backend() {
    const fs::path path = find_module();
    const intersect::process::FloatingPointGuard guard;
    // The module is never closed, because the library behind it starts threads and registers exit handlers. Symbols
    // are resolved lazily, because resolving all 168 000 symbols of the library and its dependencies at once takes a
    // tenth of a second.
    void* handle = ::dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (handle == nullptr) fail_cannot_load(path, ::dlerror());

    const auto abi = reinterpret_cast<int (*)()>(::dlsym(handle, "lostbits_image_abi"));
    const auto get_backend = reinterpret_cast<ImageBackend* (*)()>(::dlsym(handle, "lostbits_image_backend"));
    if (abi == nullptr || get_backend == nullptr) fail_wrong_module(path, "is not an image module of lostbits");
    if (abi() != image_module_abi) fail_wrong_module(path, "this image module belongs to another build");
    return *get_backend();
}

}  // namespace

ImageBackend& image_backend() {
    static std::mutex mutex;
    static ImageBackend* backend = nullptr;  // a failed load is tried again, and reported again
    const std::lock_guard lock(mutex);
    if (backend == nullptr) backend = &load_backend();
    return *backend;
}

FileMetadata metadata_of(const fs::path& path) {
    const auto provenance = file::provenance_of(path);
    if (!provenance) return {};
    FileMetadata metadata{{"Software", provenance->program}, {"lostbits:command", provenance->command}};
    if (!provenance->forms.empty()) metadata.emplace_back("lostbits:forms", file::external_forms_text(*provenance));
    return metadata;
}

std::unique_ptr<PngWriter> ImageBackend::open_png(const fs::path& path, int width, int height) {
    if (width <= 0 || height <= 0) throw std::logic_error(path.string() + ": a PNG without pixels");
    return open_png(std::make_unique<file::AtomicFile>(path), width, height);
}

std::unique_ptr<PngWriter> ImageBackend::open_png(std::unique_ptr<file::AtomicFile> file, int width, int height) {
    const fs::path path = file->path();
    if (width <= 0 || height <= 0) throw std::logic_error(path.string() + ": a PNG without pixels");
    return make_png(std::move(file), path.string(), {width, height, metadata_of(path)});
}

namespace {

/// A sink that keeps the bytes in memory.
class MemorySink final : public file::ByteSink {
public:
    explicit MemorySink(std::string& bytes) : bytes_(bytes) {}
    void write(std::span<const std::byte> added) override {
        if (position_ + added.size() > bytes_.size()) bytes_.resize(position_ + added.size());
        std::memcpy(bytes_.data() + position_, added.data(), added.size());
        position_ += added.size();
    }
    void seek(std::int64_t offset) override { position_ = static_cast<std::size_t>(offset); }
    [[nodiscard]] std::int64_t tell() const noexcept override { return static_cast<std::int64_t>(position_); }
    void commit() override {}

private:
    std::string& bytes_;
    std::size_t position_ = 0;
};

}  // namespace

std::string ImageBackend::png_bytes(int width, int height, std::span<const Rgb8> pixels) {
    std::string bytes;
    const auto png = make_png(std::make_unique<MemorySink>(bytes), "picture in memory", {width, height, {}});
    png->write_rows(height, pixels);
    png->close();
    return bytes;
}

const ExrChannel* ExrImage::find(std::string_view name) const {
    for (const auto& channel : channels) {
        if (channel.name == name) return &channel;
    }
    return nullptr;
}

}  // namespace lostbits::output::image
