// Runs an OpenCL kernel behind a pipe, on the first device:
//   c++ -O2 -o opencl_sphere examples/pipes/opencl_sphere.cpp -lOpenCL
//   lostbits map near-benign --pipe './opencl_sphere examples/pipes/sphere.cl' -o out
// After the file, a name may follow (default: opencl.sphere), then options for the compiler of kernels:
//   --pipe './opencl_sphere examples/pipes/sphere.cl opencl.fast -cl-fast-relaxed-math'
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <fstream>
#include <iterator>

#include "batches.hpp"

namespace {

cl_device_id first_device() {
    cl_uint platforms = 0;
    clGetPlatformIDs(0, nullptr, &platforms);
    std::vector<cl_platform_id> all(platforms);
    if (platforms > 0) clGetPlatformIDs(platforms, all.data(), nullptr);
    for (cl_platform_id platform : all) {
        cl_device_id device;
        if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, nullptr) == CL_SUCCESS) return device;
    }
    batches::refuse("missing", "no OpenCL device was found; install pocl-opencl-icd to use the processor");
}

std::string query_device(cl_device_id device, cl_device_info what) {
    char text[256] = "";
    clGetDeviceInfo(device, what, sizeof text - 1, text, nullptr);
    return text;
}

void require(cl_int status, const char* what) {
    if (status != CL_SUCCESS) batches::fail(std::string("OpenCL cannot ") + what + ": error " + std::to_string(status));
}

// The kernel `intersect` in a file.
class Kernel {
public:
    Kernel(const std::string& file, const std::string& options) {
        cl_device_id device = first_device();
        cl_int status = CL_SUCCESS;
        context_ = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status);
        if (status == CL_SUCCESS) queue_ = clCreateCommandQueue(context_, device, 0, &status);
        if (status != CL_SUCCESS) batches::refuse("missing", "the OpenCL device cannot be opened");
        std::ifstream in(file);
        const std::string text{std::istreambuf_iterator<char>(in), {}};
        if (text.empty()) batches::refuse("error", file + ": cannot be read, or is empty");
        const char* begin = text.c_str();
        cl_program program = clCreateProgramWithSource(context_, 1, &begin, nullptr, nullptr);
        if (clBuildProgram(program, 1, &device, options.c_str(), nullptr, nullptr) != CL_SUCCESS) {
            std::vector<char> log(1 << 16);
            clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, log.size() - 1, log.data(), nullptr);
            std::fprintf(stderr, "%s\n", log.data());
            batches::refuse("error", file + ": does not compile, see above; options: " + options);
        }
        kernel_ = clCreateKernel(program, "intersect", &status);
        if (status != CL_SUCCESS) batches::refuse("error", file + ": has no kernel `intersect`");
        // `source_` names the device and the driver, since results depend on them.
        source_ = file + " [" + options + "] on " + query_device(device, CL_DEVICE_NAME) + ", " +
                  query_device(device, CL_DEVICE_VERSION) + ", driver " + query_device(device, CL_DRIVER_VERSION);
    }

    const std::string& source() const { return source_; }

    void answer(batches::Batch& batch) const {
        const std::size_t near_far_bytes = batch.near_far.size() * sizeof(float);
        cl_mem rays = given(batch.rays), spheres = given(batch.spheres), near_far = written(near_far_bytes),
               hit = written(batch.hit.size());
        cl_uint place = 0;
        const auto pass = [&](const auto& argument) {
            require(clSetKernelArg(kernel_, place++, sizeof argument, &argument), "take an argument");
        };
        pass(rays);
        pass(spheres);
        pass(batch.stride);
        pass(batch.count);
        pass(near_far);
        pass(hit);
        const std::size_t places = (batch.count + 63UL) / 64 * 64;
        require(clEnqueueNDRangeKernel(queue_, kernel_, 1, nullptr, &places, nullptr, 0, nullptr, nullptr), "run");
        read(near_far, near_far_bytes, batch.near_far.data());
        read(hit, batch.hit.size(), batch.hit.data());
        for (cl_mem memory : {rays, spheres, near_far, hit}) clReleaseMemObject(memory);
    }

private:
    cl_mem memory(cl_mem_flags way, std::size_t bytes, void* from) const {
        cl_int status = CL_SUCCESS;
        cl_mem made = clCreateBuffer(context_, way, bytes, from, &status);
        require(status, "make a buffer");
        return made;
    }
    cl_mem given(std::vector<float>& numbers) const {
        return memory(CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, numbers.size() * sizeof(float), numbers.data());
    }
    cl_mem written(std::size_t bytes) const { return memory(CL_MEM_WRITE_ONLY, bytes, nullptr); }
    void read(cl_mem from, std::size_t bytes, void* into) const {
        require(clEnqueueReadBuffer(queue_, from, CL_TRUE, 0, bytes, into, 0, nullptr, nullptr), "read the answers");
    }

    cl_context context_ = nullptr;
    cl_command_queue queue_ = nullptr;
    cl_kernel kernel_ = nullptr;
    std::string source_;
};

}  // namespace

int main(int count, char** words) {
    if (count < 2) batches::refuse("error", "usage: opencl_sphere FILE.cl [NAME [OPTION...]]");
    const std::string name = count > 2 ? words[2] : "opencl.sphere";
    std::string options;
    for (int k = 3; k < count; ++k) options += (k > 3 ? " " : "") + std::string(words[k]);
    const Kernel kernel(words[1], options);
    batches::serve("name=" + name + "\nshape=sphere\nformat=f32\nroots=both\nflags=line,one_thread\nsource=" +
                       kernel.source() + "\n",
                   [&kernel](batches::Batch& batch) { kernel.answer(batch); });
}
