// Runs the kernel of sphere.cl in CUDA behind a pipe, on the first card:
//   nvcc -std=c++17 -o cuda_sphere examples/pipes/cuda_sphere.cu
//   lostbits map near-benign --pipe ./cuda_sphere -o out
// nvcc rounds a * b + c only once, unless -fmad=false is given. docs/pipe.md says which parts of this were run.
#include <cuda_runtime.h>

#include "batches.hpp"
#include "sphere.cl"

namespace {

void require(cudaError_t status, const char* what) {
    if (status != cudaSuccess) batches::fail(std::string("CUDA cannot ") + what + ": " + cudaGetErrorString(status));
}

// Memory of the card, which the destructor frees.
class Memory {
public:
    explicit Memory(std::size_t bytes) { require(cudaMalloc(&at_, bytes), "allocate memory"); }
    explicit Memory(const std::vector<float>& numbers) : Memory(numbers.size() * sizeof(float)) {
        require(cudaMemcpy(at_, numbers.data(), numbers.size() * sizeof(float), cudaMemcpyHostToDevice), "send rays");
    }
    ~Memory() { cudaFree(at_); }
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    void* argument() { return &at_; }
    void read(void* into, std::size_t bytes) const {
        require(cudaMemcpy(into, at_, bytes, cudaMemcpyDeviceToHost), "read the answers");
    }

private:
    void* at_ = nullptr;
};

void answer(batches::Batch& batch) {
    const std::size_t near_far_bytes = batch.near_far.size() * sizeof(float);
    Memory rays(batch.rays), spheres(batch.spheres), near_far(near_far_bytes), hit(batch.hit.size());
    void* arguments[] = {rays.argument(), spheres.argument(),  &batch.stride,
                         &batch.count,    near_far.argument(), hit.argument()};
    const unsigned threads = 64, blocks = (batch.count + threads - 1) / threads;
    require(cudaLaunchKernel(reinterpret_cast<const void*>(intersect), dim3(blocks), dim3(threads), arguments, 0, 0),
            "run");
    near_far.read(batch.near_far.data(), near_far_bytes);
    hit.read(batch.hit.data(), batch.hit.size());
}

}  // namespace

int main() {
    int cards = 0;
    const cudaError_t status = cudaGetDeviceCount(&cards);
    if (status != cudaSuccess || cards == 0)
        batches::refuse("missing", std::string("no CUDA card was found: ") + cudaGetErrorString(status));
    cudaDeviceProp card{};
    require(cudaGetDeviceProperties(&card, 0), "read the properties of the card");
    // `source` names the hardware and the runtime, since results depend on them.
    batches::serve(
        "name=cuda.sphere\nshape=sphere\nformat=f32\nroots=both\nflags=line,one_thread\nsource=sphere.cl on " +
            std::string(card.name) + ", compute capability " + std::to_string(card.major) + "." +
            std::to_string(card.minor) + ", runtime " + std::to_string(CUDART_VERSION) + "\n",
        answer);
}
